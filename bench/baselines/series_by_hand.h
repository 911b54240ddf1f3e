/* series_by_hand.h - Computes the recurrences of the Taylor series of Kepler's problem and the Solar System, written by
 * hand: with coefficients scaled by the step, q_k = h^k q^(k)/k!, and a = -G m w d summed over the other bodies,
 *   s = d.d:  s_k = sum_{j=0}^k d_j.d_{k-j},    (w d)_k = sum_{j=0}^k w_j d_{k-j},
 *   w = s^(-3/2), s w' = -3/2 w s':  k s_0 w_k = sum_{j=1}^k (-3/2 j - (k-j)) s_j w_{k-j}. */
#ifndef SERIES_BY_HAND_H
#define SERIES_BY_HAND_H

#include "forces.h"

enum { DEGREE_MAX = 24 };

/* (-3/2 j - (k-j))/k of the recurrence of w. */
typedef struct {
    double of[DEGREE_MAX + 1][DEGREE_MAX + 1]; /* [k][j] */
} power_weights;

static inline void set_power_weights(int N, power_weights *w)
{
    for (int k = 1; k <= N; k++)
        for (int j = 1; j <= k; j++) w->of[k][j] = (-1.5 * j - (k - j)) / k;
}

/* ---- Kepler ------------------------------------------------------------------------------------------------------ */

typedef struct {
    double x[DEGREE_MAX + 1], y[DEGREE_MAX + 1], u[DEGREE_MAX + 1], v[DEGREE_MAX + 1]; /* q = (x, y), q' = (u, v) */
    double s[DEGREE_MAX + 1], w[DEGREE_MAX + 1];
} kepler_series;

/* Coefficient k of s and w from those of x and y up to k. */
static INLINE void kepler_power(int k, const power_weights *weights, kepler_series *c)
{
    double s = 0, w = 0;
    for (int j = 0; 2 * j < k; j++) s += 2 * (c->x[j] * c->x[k - j] + c->y[j] * c->y[k - j]);
    if (k % 2 == 0) s += c->x[k / 2] * c->x[k / 2] + c->y[k / 2] * c->y[k / 2];
    c->s[k] = s;
    for (int j = 1; j <= k; j++) w += weights->of[k][j] * c->s[j] * c->w[k - j];
    c->w[k] = k == 0 ? 1 / (s * sqrt(s)) : w / c->s[0];
}

/* Coefficient k of the acceleration from those of x and y up to k. */
static INLINE void kepler_acceleration(int k, const power_weights *weights, kepler_series *c, double *a)
{
    double ax = 0, ay = 0;
    kepler_power(k, weights, c);
    for (int j = 0; j <= k; j++) {
        ax -= c->w[j] * c->x[k - j];
        ay -= c->w[j] * c->y[k - j];
    }
    a[0] = ax, a[1] = ay;
}

/* ---- The Solar System: its 15 pairs are lanes, with one that repeats the first ----------------------------------- */

enum { BODIES = 6, PAIRS = 15, LANES = 16 };
typedef double pair_lanes[LANES];

typedef struct {
    _Alignas(64) pair_lanes x[DEGREE_MAX + 1], y[DEGREE_MAX + 1], z[DEGREE_MAX + 1], s[DEGREE_MAX + 1],
        w[DEGREE_MAX + 1];
    double q[DEGREE_MAX + 1][18], v[DEGREE_MAX + 1][18];
} solar_series;

/* s_k = 2 sum_{2j<k} d_j.d_{k-j} + |d_{k/2}|^2 for even k. */
static INLINE void solar_square(int k, solar_series *c)
{
    pair_lanes sum = {0};
    for (int j = 0; 2 * j < k; j++)
        FOR_EACH_LANE(l, LANES)
            sum[l] += c->x[j][l] * c->x[k - j][l] + c->y[j][l] * c->y[k - j][l] + c->z[j][l] * c->z[k - j][l];
    FOR_EACH_LANE(l, LANES) sum[l] *= 2;
    if (k % 2 == 0) {
        const double *x = c->x[k / 2], *y = c->y[k / 2], *z = c->z[k / 2];
        FOR_EACH_LANE(l, LANES) sum[l] += x[l] * x[l] + y[l] * y[l] + z[l] * z[l];
    }
    FOR_EACH_LANE(l, LANES) c->s[k][l] = sum[l];
}

/* Coefficient k of s and w from those of d up to k. */
static INLINE void solar_power(int k, const power_weights *weights, solar_series *c)
{
    pair_lanes sum = {0};
    solar_square(k, c);
    if (k == 0) {
        FOR_EACH_LANE(l, LANES) c->w[0][l] = 1 / (c->s[0][l] * sqrt(c->s[0][l]));
        return;
    }
    for (int j = 1; j <= k; j++)
        FOR_EACH_LANE(l, LANES) sum[l] += weights->of[k][j] * c->s[j][l] * c->w[k - j][l];
    FOR_EACH_LANE(l, LANES) c->w[k][l] = sum[l] / c->s[0][l];
}

static INLINE void solar_distances(int k, solar_series *c)
{
    int l = 0;
    for (int i = 1; i < BODIES; i++)
        for (int j = 0; j < i; j++, l++) {
            c->x[k][l] = c->q[k][3 * i] - c->q[k][3 * j];
            c->y[k][l] = c->q[k][3 * i + 1] - c->q[k][3 * j + 1];
            c->z[k][l] = c->q[k][3 * i + 2] - c->q[k][3 * j + 2];
        }
    c->x[k][PAIRS] = c->x[k][0], c->y[k][PAIRS] = c->y[k][0], c->z[k][PAIRS] = c->z[k][0];
}

/* Coefficient k of the acceleration from those of q up to k: a_i -= G m_j w d, a_j += G m_i w d. */
static INLINE void solar_acceleration(int k, const power_weights *weights, solar_series *c, double *a)
{
    pair_lanes f[3] = {{0}};
    solar_distances(k, c);
    solar_power(k, weights, c);
    for (int j = 0; j <= k; j++)
        FOR_EACH_LANE(l, LANES) {
            f[0][l] += c->w[j][l] * c->x[k - j][l];
            f[1][l] += c->w[j][l] * c->y[k - j][l];
            f[2][l] += c->w[j][l] * c->z[k - j][l];
        }
    for (int i = 0; i < 3 * BODIES; i++) a[i] = 0;
    int l = 0;
    for (int i = 1; i < BODIES; i++)
        for (int j = 0; j < i; j++, l++)
            for (int m = 0; m < 3; m++) {
                a[3 * i + m] -= SOLAR_G * SOLAR_MASS[j] * f[m][l];
                a[3 * j + m] += SOLAR_G * SOLAR_MASS[i] * f[m][l];
            }
}

#endif
