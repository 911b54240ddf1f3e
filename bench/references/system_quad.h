/* system_quad.h - Declares what the methods of quad.h need of its systems. */
#ifndef TVI_BENCH_SYSTEM_QUAD_H
#define TVI_BENCH_SYSTEM_QUAD_H

#include "program_quad.h"
#include "quad.h"

struct quad_system {
    int n;
    quad *mass;
    quad_program force, potential; /* potential.outputs is 0 where there is none */
};

/* q and q' at s of the curve c, to this degree. */
void quad_position(int n, int degree, const quad c[], quad s, quad x[]);
void quad_velocity(int n, int degree, const quad c[], quad s, quad x[]);

#endif
