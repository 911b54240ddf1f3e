/* gravity.c - Computes potentials and time scales of bodies that attract each other, for the scenes (gravity.h). */
#include "gravity.h"

#include <math.h>

enum { PAIRS_MAX = GRAVITY_BODIES_MAX * (GRAVITY_BODIES_MAX - 1) / 2, AXES_MAX = 3 };

/* |q_i - q_j|^2 */
static jet square_of_distance(const jet q[], int i, int j, int axes)
{
    jet d[AXES_MAX];
    for (int k = 0; k < axes; k++) d[k] = jet_sub(q[axes * i + k], q[axes * j + k]);
    return jet_dot(d, d, axes);
}

jet gravity_potential(const jet q[], int bodies, int axes, const double mass[])
{
    jet term[PAIRS_MAX];
    int pairs = 0;
    for (int i = 1; i < bodies; i++)
        for (int j = 0; j < i; j++)
            term[pairs++] = jet_mul(-mass[i] * mass[j], jet_pow(square_of_distance(q, i, j, axes), -0.5));
    return jet_sum(term, pairs);
}

jet gravity_scale(const jet q[], int bodies, int axes, const double mass[], double k)
{
    jet term[PAIRS_MAX];
    int pairs = 0;
    for (int i = 1; i < bodies; i++)
        for (int j = 0; j < i; j++)
            term[pairs++] = jet_mul(pow(mass[i] + mass[j], k / 3), jet_pow(square_of_distance(q, i, j, axes), -k / 2));
    return jet_pow(jet_sum(term, pairs), -1.5 / k);
}
