/* taylor_loops.c - computes the loops over members that taylor_loops.h declares. */
#include "generating/taylor_loops.h"
#include "algebra/sizes.h"
#include "algebra/tail.h"
#include "rule.h"
#include "vector.h"

#include <math.h>

/* ROW is row i of order k. */
#define ROW(curve, k, i) ((curve)->x + (size_t)(k) * (curve)->stride + (size_t)(i) * (size_t)(curve)->width)

/* Advances the recurrence; as in curve.c, tau and the divisor are not made one factor. */
static void advance(const tvi_taylor_lanes *curve, int k)
{
    const int n = curve->n, width = curve->width, of_p = curve->has_masses ? 0 : n;
    const double tau = curve->tau, divisor = curve->has_masses ? (k + 1) * (k + 2) : k + 1;
    for (int i = 0; i < n + of_p; i++) {
        const double *field = ROW(curve, k, curve->output[of_p && i < n ? n + i : i - of_p]);
        const double kappa = curve->has_masses ? curve->kappa[i] : of_p && i >= n ? -1 : 1;
        double *restrict next = ROW(curve, curve->has_masses ? k + 2 : k + 1, i);
        for (int m = 0; m < width; m++) next[m] = kappa * field[m] * tau / divisor;
    }
}

/* Computes sum_{k=from}^{to} factor_k |row i of order k|, small terms first; factor_k = k, or k (k - 1) of p = Q'. */
#define SUM_SIZES(V, S)                                                                                                \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        for (int k = to; k >= from; k--)                                                                               \
            sum += (double)(of_slope ? k * (k - 1) : k) * JET_ABS(V, *(const V *)(ROW(curve, k, i) + here));           \
        *(V *)(out + here) = sum;                                                                                      \
    }

JET_INLINE void sum_sizes(const tvi_taylor_lanes *curve, int i, int from, int to, bool of_slope, double *out)
{
    JET_BLOCKS_OF_8(curve->width, SUM_SIZES, )
}

static void measure(const tvi_taylor_lanes *curve, int q_degree, int p_degree, const tvi_taylor_sums *sums)
{
    for (int i = 0; i < curve->n; i++) {
        const int here = i * curve->width;
        double *const momentum = sums->bend + here;
        const double *p0 = curve->has_masses ? ROW(curve, 1, i) : ROW(curve, 0, curve->n + i);
        sum_sizes(curve, i, 1, q_degree, false, sums->size + here);
        if (curve->has_masses) sum_sizes(curve, i, 2, p_degree + 1, true, momentum);
        else sum_sizes(curve, curve->n + i, 1, p_degree, false, momentum);
        for (int m = 0; m < curve->width; m++) momentum[m] += fabs(p0[m]);
    }
}

/* Computes shares and ratios as curve_tail_part of series.h does, with momenta in the unit of kappa p. */
JET_INLINE void tails_of(const tvi_taylor_lanes *curve, int q_degree, int p_degree, bool has_masses,
                         const tvi_taylor_sums *sums, double *restrict share, double *restrict ratio)
{
    const int width = curve->width, n = curve->n;
    const double of_p = has_masses ? p_degree + 1 : 1;
    for (int i = 0, at = 0; i < n; i++, share += width, ratio += width) {
        const double *q0 = ROW(curve, 0, i)
        , *last_q = ROW(curve, q_degree, i);
        const double *last_p = has_masses ? ROW(curve, p_degree + 1, i) : ROW(curve, p_degree, n + i);
        for (int m = 0; m < width; m++, at++) {
            tvi_tail_part part = {.momentum = sums->bend[at],
                                  .movement = sums->size[at],
                                  .last_p = p_degree * fabs(of_p * last_p[m]),
                                  .last_q = has_masses ? 0 : q_degree * fabs(last_q[m]),
                                  .position = fabs(q0[m])};
            part.per_momentum = 1 / part.momentum;
            part.per_movement = 1 / part.movement;
            share[m] = tvi_tail_share(&part, has_masses || curve->system->compares_movements);
            ratio[m] = tvi_tail_ratio(&part);
        }
    }
}

static void tail(const tvi_taylor_lanes *curve, int q_degree, int p_degree, const tvi_taylor_sums *sums, double *share,
                 double *ratio, double *out)
{
    if (curve->has_masses) tails_of(curve, q_degree, p_degree, true, sums, share, ratio);
    else tails_of(curve, q_degree, p_degree, false, sums, share, ratio);
    tvi_tails_of_members(&curve->system->parts, curve->n, curve->width, share, ratio, out);
}

static void sweep(const tvi_taylor_rows *rows, const double *power, double *x, const tvi_taylor_sums *sums)
{
    taylor_sweep(rows, power, x, sums);
}

const tvi_taylor_loops JET_FOR_ISA(tvi_taylor_loops) = {advance, measure, tail, sweep};
