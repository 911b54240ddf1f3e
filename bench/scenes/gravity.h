/* gravity.h - Declares bodies that attract each other with G = 1, body i at q[axes i], ..., q[axes i + axes - 1]. */
#ifndef GRAVITY_H
#define GRAVITY_H

#include "tvi.h"

enum { GRAVITY_BODIES_MAX = 8 };

/* V = -sum_{i<j} m_i m_j / |q_i - q_j|. */
jet gravity_potential(const jet q[], int bodies, int axes, const double mass[]);
/* A time scale that follows the closest pairs, of which a single one has (|q_i - q_j|^3 / (m_i + m_j))^(1/2):
 * g = (sum_{i<j} ((m_i + m_j)^(1/3) / |q_i - q_j|)^k)^(-3/(2k)). The smaller k is, the smoother it changes from one
 * pair to another; the larger, the less do those matter that are not close. */
jet gravity_scale(const jet q[], int bodies, int axes, const double mass[], double k);

/* Defines both as functions of a scene: potential and scale, of bodies with the masses of an array. */
#define GRAVITY_OF(mass, axes, k)                                                                                      \
    enum { BODIES = sizeof mass / sizeof *mass };                                                                      \
    static jet potential(const jet q[], jet t, void *ctx)                                                              \
    {                                                                                                                  \
        (void)t, (void)ctx;                                                                                            \
        return gravity_potential(q, BODIES, axes, mass);                                                               \
    }                                                                                                                  \
    static jet scale(const jet q[], const jet p[], jet t, void *ctx)                                                   \
    {                                                                                                                  \
        (void)p, (void)t, (void)ctx;                                                                                   \
        return gravity_scale(q, BODIES, axes, mass, k);                                                                \
    }

#endif
