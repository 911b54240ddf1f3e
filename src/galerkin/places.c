/* places.c - Evaluates the curve of the last step at other points: dense output, and the samples of a search for
 * events. */
#include "galerkin/step.h"

enum { MAX_LANES = TVI_GALERKIN_MAX_LANES };

/* Computes x [components][places] = start + its change up to theta, by a table of dense.h, [lanes][places], and the
 * impulses. */
static void integrate_impulses(const galerkin *w, tvi_component_range range, int places, const double theta[],
                               const double *table, const double *impulses, const double *start, const double *drift,
                               const double *rise, double *x)
{
    const int lanes = w->field.nodes.lanes, from = range.first, count = range.end - from;
    const galerkin_evaluation to = {lanes, places, count, theta, start + from, drift + from, rise + from};
    if (count > 0) w->field.loops->evaluate(&to, table, impulses + from * lanes, x + from * places);
}

/* Computes q, p [n][places], components used[0] of q and used[1] of p. It integrates the polynomial of degree m - 1
 * through the rates. */
static void follow_curve(const galerkin *w, const tvi_component_range used[2], int places, const double theta[],
                         const double *once, const double *twice, const double q_start[], const double p_start[],
                         double *q, double *p)
{
    const double *impulses = tvi_galerkin_impulses(&w->predictor, 0), *of_p = impulses;
    const bool separable = galerkin_is_second_order(&w->field);
    if (!separable) of_p += w->n * w->field.nodes.lanes;
    integrate_impulses(w, used[0], places, theta, separable ? twice : once, impulses, q_start, w->drift, w->rise, q);
    integrate_impulses(w, used[1], places, theta, once, of_p, p_start, w->predictor.none, w->rise + w->n, p);
}

void tvi_galerkin_dense(void *work, double theta, double dq[], double dp[])
{
    const galerkin *w = work;
    const tvi_component_range all[] = {{0, w->n}, {0, w->n}};
    double once[MAX_LANES] = {0}, twice[MAX_LANES] = {0};
    tvi_galerkin_dense_integrate(&w->dense, theta, once, twice);
    follow_curve(w, all, 1, &theta, once, twice, w->predictor.none, w->predictor.none, dq, dp);
}

void tvi_galerkin_sample(void *work, const tvi_component_range used[2], const double q_start[], const double p_start[],
                         double *q, double *p)
{
    const galerkin *w = work;
    follow_curve(w, used, TVI_SAMPLES, tvi_sample_theta, w->dense.once, w->dense.twice, q_start, p_start, q, p);
}
