/* taylor_loops.c - see taylor_loops.h. */
#include "generating/taylor_loops.h"
#include "algebra/sizes.h"
#include "algebra/tail.h"
#include "rule.h"
#include "vector.h"

#include <math.h>

/* Row i of order k. */
#define ROW(curve, k, i) ((curve)->x + (size_t)(k) * (curve)->stride + (size_t)(i) * (size_t)(curve)->width)

/* As in curve.c: tau and the divisor are not made one factor. */
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

/* sum_k factor_k row i of order k, k = from .. to, factor_k = k or 1. */
#define SUM(V, S)                                                                                                      \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        for (int k = to; k >= from; k--) sum += (by_order ? k : 1) * *(const V *)(ROW(curve, k, i) + here);            \
        *(V *)(out + here) = sum / divisor;                                                                            \
    }

JET_INLINE void sum_up(const tvi_taylor_lanes *curve, int i, int from, int to, bool by_order, double divisor,
                       double *out)
{
    JET_EIGHTS(curve->width, SUM, )
}

/* U_k = (k + 1) Q_{k+1} of a separable system. */
static void rise(const tvi_taylor_lanes *curve, int q_degree, int p_degree, double *dq, double *dp)
{
    for (int i = 0; i < curve->n; i++, dq += curve->width, dp += curve->width) {
        sum_up(curve, i, 1, q_degree, false, 1, dq);
        if (curve->has_masses) sum_up(curve, i, 2, p_degree + 1, true, curve->kappa[i], dp);
        else sum_up(curve, curve->n + i, 1, p_degree, false, 1, dp);
    }
}

/* sum_{k=from}^{to} factor_k |row i of order k|, and its last term; factor_k = k, or k (k - 1) of p = Q'. */
#define SUM_SIZES(V, S)                                                                                                \
    {                                                                                                                  \
        V sum = {0}, term = {0};                                                                                       \
        for (int k = from; k <= to; k++) {                                                                             \
            const V x = *(const V *)(ROW(curve, k, i) + here);                                                         \
            term = (double)(of_slope ? k * (k - 1) : k) * JET_ABS(V, x);                                               \
            sum += term;                                                                                               \
        }                                                                                                              \
        *(V *)(all + here) = sum;                                                                                      \
        *(V *)(last + here) = term;                                                                                    \
    }

JET_INLINE void sum_sizes(const tvi_taylor_lanes *curve, int i, int from, int to, bool of_slope, double *all,
                          double *last){JET_EIGHTS(curve->width, SUM_SIZES, )}

/* As tail_part of curve.c, momenta in the unit of kappa p. */
JET_INLINE void tails_of(const tvi_taylor_lanes *curve, int q_degree, int p_degree, bool has_masses,
                         double *restrict share, double *restrict ratio)
{
    double p[TVI_TAIL_MOST_WIDTH], last_p[TVI_TAIL_MOST_WIDTH], q[TVI_TAIL_MOST_WIDTH], last_q[TVI_TAIL_MOST_WIDTH];
    const int width = curve->width, n = curve->n;
    for (int i = 0; i < n; i++, share += width, ratio += width) {
        const double *q0 = ROW(curve, 0, i)
        , *p0 = has_masses ? ROW(curve, 1, i) : ROW(curve, 0, n + i);
        sum_sizes(curve, i, 1, q_degree, false, q, last_q);
        if (has_masses) sum_sizes(curve, i, 2, p_degree + 1, true, p, last_p);
        else sum_sizes(curve, n + i, 1, p_degree, false, p, last_p);
        for (int m = 0; m < width; m++) {
            tvi_tail_part part = {.momentum = fabs(p0[m]) + p[m],
                                  .movement = q[m],
                                  .last_p = last_p[m],
                                  .last_q = has_masses ? 0 : last_q[m],
                                  .place = fabs(q0[m])};
            part.per_momentum = 1 / part.momentum;
            part.per_movement = 1 / part.movement;
            share[m] = tvi_tail_share(&part, has_masses || curve->system->has_masses);
            ratio[m] = tvi_tail_ratio(&part);
        }
    }
}

static void tail(const tvi_taylor_lanes *curve, int q_degree, int p_degree, double *share, double *ratio, double *out)
{
    if (curve->has_masses) tails_of(curve, q_degree, p_degree, true, share, ratio);
    else tails_of(curve, q_degree, p_degree, false, share, ratio);
    tvi_tails_of_members(&curve->system->parts, curve->n, curve->width, share, ratio, out);
}

static void sweep(const tvi_taylor_rows *rows, const double *power, double *x, const tvi_taylor_sums *sums)
{
    taylor_sweep(rows, power, x, sums);
}

const tvi_taylor_loops JET_FOR_ISA(tvi_taylor_loops) = {advance, rise, tail, sweep};
