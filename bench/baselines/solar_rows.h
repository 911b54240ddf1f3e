/* solar_rows.h - Computes the Solar System's accelerations with its bodies as lanes, for methods that need them at one
 * point at a time: q and a are [3][8], x, y and z of bodies 0 1 2 3 4 5 0 1. */
#ifndef SOLAR_ROWS_H
#define SOLAR_ROWS_H

#include "forces.h"

#include <string.h>

enum { ROW = 8, ROWS = 3 * ROW };
typedef double row __attribute__((vector_size(ROW * sizeof(double))));

/* Row of body i: the values of body i + by (modulo 6). */
#define TURNED(x, by)                                                                                                  \
    __builtin_shufflevector(x, x, (by) % 6, (1 + by) % 6, (2 + by) % 6, (3 + by) % 6, (4 + by) % 6, (5 + by) % 6,      \
                            (by) % 6, (1 + by) % 6)

/* *w = r2^(-3/2). */
static INLINE void inverse_cube(const row *r2, row *w)
{
    _Alignas(64) double in[ROW], out[ROW];
    memcpy(in, r2, sizeof in);
    FOR_EACH_LANE(l, ROW) out[l] = 1 / (in[l] * sqrt(in[l]));
    memcpy(w, out, sizeof out);
}

/* a_i += G m_{i+by} d / |d|^3, d = q_{i+by} - q_i, and, in the other direction, a_{i+by} -= G m_i d / |d|^3, unless
 * by = 3, which has both already. */
#define ATTRACT(by)                                                                                                    \
    do {                                                                                                               \
        row d[3], w;                                                                                                   \
        for (int k = 0; k < 3; k++) d[k] = TURNED(x[k], by) - x[k];                                                    \
        const row r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];                                                        \
        inverse_cube(&r2, &w);                                                                                         \
        for (int k = 0; k < 3; k++) {                                                                                  \
            d[k] *= w;                                                                                                 \
            f[k] += TURNED(gm, by) * d[k];                                                                             \
            if (by < 3) f[k] -= TURNED(gm, (6 - by)) * TURNED(d[k], (6 - by));                                         \
        }                                                                                                              \
    } while (0)

static INLINE void solar_rows(const double *restrict q, double *restrict a)
{
    row x[3], f[3] = {{0}}, gm;
    for (int i = 0; i < ROW; i++) gm[i] = SOLAR_G * SOLAR_MASS[i % 6];
    memcpy(x, q, sizeof x);
    ATTRACT(1);
    ATTRACT(2);
    ATTRACT(3);
    memcpy(a, f, sizeof f);
}

#endif
