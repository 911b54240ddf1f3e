/* equations_quad.h - Declares Hamilton's equations of the general scenes, derived by hand, in quadruple precision (gcc
 * only). */
#ifndef TESTS_GENERATING_EQUATIONS_QUAD_H
#define TESTS_GENERATING_EQUATIONS_QUAD_H

#include "references/quad.h"
#include "scene.h"

enum { EQUATIONS_MOST = 4 }; /* degrees of freedom */

typedef struct {
    quad q[EQUATIONS_MOST], p[EQUATIONS_MOST];
} quad_point;

typedef struct {
    const scene *scene;
    /* dx = (q', p') at x. */
    void (*field)(const quad_point *x, quad_point *dx);
} quad_equations;

/* double pendulum, magnetic, nonseparable, vortices, degenerate */
enum { EQUATIONS = 5 };
extern const quad_equations equations[EQUATIONS];

#endif
