/* bodies.c - Creates systems of any size (bodies.h). */
#include "bodies.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- Gravity ----------------------------------------------------------------------------------------------------- */

typedef struct {
    int count, dimensions;
    const double *mass; /* of coordinates */
} gravity;

/* V = -sum_{i<j} m_i m_j / |q_i - q_j|. */
static jet gravity_potential(const jet q[], jet t, void *ctx)
{
    const gravity *g = ctx;
    const int dimensions = g->dimensions;
    jet V = jet_const(0), d[3];
    (void)t;
    for (int i = 1; i < g->count; i++)
        for (int j = 0; j < i; j++) {
            for (int k = 0; k < dimensions; k++) d[k] = jet_sub(q[dimensions * i + k], q[dimensions * j + k]);
            const double masses = g->mass[dimensions * i] * g->mass[dimensions * j];
            V = jet_sub(V, jet_mul(masses, jet_pow(jet_dot(d, d, dimensions), -0.5)));
        }
    return V;
}

/* Planet i at distance r = 1 + 0.4 i and angle 2.4 i, with the speed of a circle. */
static void place_planet(int i, int dimensions, big_system *b, double mass[])
{
    const double r = 1 + 0.4 * i, angle = 2.4 * i, m = 1e-4 / (1 + i % 3);
    double *q = b->q + dimensions * i, *p = b->p + dimensions * i;
    for (int k = 0; k < dimensions; k++) mass[dimensions * i + k] = m;
    q[0] = r * cos(angle), q[1] = r * sin(angle);
    p[0] = -m / sqrt(r) * sin(angle), p[1] = m / sqrt(r) * cos(angle);
    if (dimensions == 3) q[2] = 0.05 * r * sin(1.3 * i), p[2] = 0;
}

big_system bodies_make(int count, int dimensions)
{
    big_system b = {.name = "gravity", .n = count * dimensions, .h = 0.5};
    double mass[COORDINATES_MOST];
    for (int k = 0; k < dimensions; k++) mass[k] = 1;
    for (int i = 1; i < count; i++) place_planet(i, dimensions, &b, mass);
    gravity g = {count, dimensions, mass};
    TVI_OR_EXIT(tvi_system_potential(&b.system, b.n, mass, gravity_potential, &g));
    return b;
}
