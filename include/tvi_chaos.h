/* tvi_chaos.h - order and chaos: the Lyapunov exponent and MEGNO of a run (docs/chaos.md). tvi_runs.h includes it. */
#ifndef TVI_CHAOS_H
#define TVI_CHAOS_H

#include "tvi_runs.h"

#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif
#ifdef __cplusplus
extern "C" {
#endif

/* What a tangent vector tells of a run. d_k is its length after k steps, at the time t_k since the start, t_0 = 0. All
 * is 0 before the first step. */
typedef struct {
    double lyapunov; /* ln(d_k / d_0) / t_k, falls as ln(t) / t on regular orbits */
    double megno; /* the mean of Y over the time: tends to 2 on regular orbits, grows as lambda t / 2 on chaotic ones */
    double y;     /* Y_k = (2 / t_k) sum_{j <= k} ln(d_j / d_{j-1}) (t_{j-1} + t_j) / 2 */
    double growth;  /* ln(d_k / d_0) */
    double time;    /* t_k, positive also where the run goes back */
    double t_start; /* the time of the integrator at the start */
    long steps;     /* k */
    size_t size;    /* sizeof(tvi_chaos), or 0: that of the first version */
} tvi_chaos;

/* Makes the run of a plan by tvi_run, with the same bits, the same reports and the same statuses, and moves a tangent
 * vector beside it: at once (tvi_run_plan.columns_at_once) where that serves the system and the method. Each step adds
 * to the sums; *chaos is set before at_step and observer are called for it, which may read it.
 *
 * The length is that of (dq, dv), dv = dp / m, and that of (dq, dp) in systems whose momenta have no masses. Without D
 * in the plan the sums begin anew, and so does a vector of the library's own: dq = 0 and dv_i = 2 frac(i / golden) -
 * 1, i = 1 .. n, golden = (1 + sqrt(5)) / 2; for a start with p = 0, where dv may be along the flow, dv = 0 and dq is
 * that. Its components all differ, since bodies that attract each other and are all moved alike do not part: dv = 1
 * would show chaos by roundoff alone, and late. D with one column in the plan is the vector, and a *chaos with steps >
 * 0 goes on with it: so runs may be cut into calls, with the same bits. If all of D is 0, it becomes the library's
 * vector. The library multiplies D by a power of two where it has grown or shrunk by 2^100; observers leave it alone.
 *   TVI_EINVAL  also chaos that is NULL or of another size, D of several columns, or with dq and dp of 0 alone
 *   others      as of tvi_run with D */
TVI_NODISCARD tvi_status tvi_run_chaos(tvi_integrator *integrator, const tvi_run_plan *plan, tvi_chaos *chaos,
                                       double *t, double q[], double p[]);

#ifdef __cplusplus
}
#endif
#if defined(__GNUC__)
#pragma GCC visibility pop
#endif

#endif
