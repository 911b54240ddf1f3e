/* step_quad.h - Declares one step of any method from its definition (docs/method.md sections 1 to 4), in quadruple
 * precision (gcc only): the discrete action as a number, its derivatives by differences. */
#ifndef TESTS_FUZZ_STEPS_STEP_QUAD_H
#define TESTS_FUZZ_STEPS_STEP_QUAD_H

#include "series_quad.h"

/* q, p at t become those at t + h. false: the equations were not solved; the state is then undefined. */
bool quad_step(quad_series *s, const tvi_options *options, quad h, quad t, quad q[], quad p[]);

/* The solution at t + h by a series of high degree. */
bool quad_flow(quad_series *s, quad h, quad t, quad q[], quad p[]);

#endif
