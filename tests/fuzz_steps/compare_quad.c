/* compare_quad.c - Implements compare.h (gcc only). */
#include "compare.h"
#include "step_quad.h"

#include <float.h>
#include <math.h>
#include <quadmath.h>

/* The time in which the state's series doubles it: min over k of (size / |c_k|)^(1/k). */
static double time_of_change(quad_series *s)
{
    const problem *x = s->source;
    quad q[N_MOST], p[N_MOST], r[N_MOST] = {0}, Q[ORDERS * N_MOST], P[ORDERS * N_MOST];
    double time = 10;
    for (int i = 0; i < N_MOST; i++) q[i] = x->q[i], p[i] = r[i] = x->p[i];
    if (x->form == OF_LAGRANGIAN && !quad_legendre(s, x->t, q, p, r)) return NAN;
    if (!quad_curve(s, x->t, q, r, ORDERS - 2, Q, P)) return NAN;
    for (int k = 1; k <= ORDERS - 2; k++)
        for (int i = 0; i < x->n; i++) {
            const double size = fmax((double)fabsq(Q[k * x->n + i]), (double)fabsq(P[k * x->n + i]));
            if (!isfinite(size)) return NAN;
            if (size > 0) time = fmin(time, pow(size, -1.0 / k));
        }
    return time;
}

/* Computes the state, and its change if every number and every operation changes by a unit of roundoff.
 */
static bool measure_roundoff(quad_series *s, double h, double unit[2])
{
    const problem *x = s->source;
    const double noise = 1e-12;
    quad q[2][N_MOST], p[2][N_MOST];
    quad largest[2] = {0, 0};
    for (int side = 0; side < 2; side++) {
        s->noise = side ? noise : 0;
        for (int i = 0; i < x->n; i++) {
            const double part = side ? noise * (1 - i % 3) : 0;
            q[side][i] = x->q[i] * (1 + part), p[side][i] = x->p[i] * (1 - part);
            largest[0] = fmaxq(largest[0], fabsq(q[side][i]));
            largest[1] = fmaxq(largest[1], fabsq(p[side][i]));
        }
        if (!quad_flow(s, h, x->t * (1 + (side ? noise : 0)), q[side], p[side])) return false;
    }
    s->noise = 0;
    for (int i = 0; i < x->n; i++) {
        largest[0] = fmaxq(largest[0], fabsq(q[1][i] - q[0][i]) / noise);
        largest[1] = fmaxq(largest[1], fabsq(p[1][i] - p[0][i]) / noise);
    }
    for (int k = 0; k < 2; k++) unit[k] = DBL_EPSILON * (double)largest[k];
    return isfinite(unit[0]) && isfinite(unit[1]);
}

/* The largest difference; infinite where it is not a number. */
static double error_of(int n, const double x[], const quad y[])
{
    quad largest = 0;
    for (int i = 0; i < n; i++) {
        const quad error = fabsq(x[i] - y[i]);
        if (!(error <= largest)) largest = error;
    }
    return finiteq(largest) ? (double)largest : INFINITY;
}

comparison compare_step(problem *x, random_source *r)
{
    comparison c = {.status = TVI_EINVAL};
    tvi_system *system = NULL;
    tvi_integrator *integrator = NULL;
    quad_series s = quad_series_of(x);
    quad exact_q[N_MOST], exact_p[N_MOST];
    double t = x->t, q[N_MOST], p[N_MOST], unit[2] = {1, 1};
    for (int i = 0; i < N_MOST; i++) exact_q[i] = q[i] = x->q[i], exact_p[i] = p[i] = x->p[i];
    c.h = time_of_change(&s) * pow(10, uniform(r, -2.5, -0.7)) * (choose(r, 2) ? 1 : -1);
    c.made = problem_system(x, &system);
    if (c.made == TVI_OK && isfinite(c.h)) {
        c.options = random_method(x->form, system, r);
        c.has_reference = quad_step(&s, &c.options, c.h, x->t, exact_q, exact_p) && measure_roundoff(&s, c.h, unit);
    }
    if (c.has_reference && tvi_integrator_create(&integrator, system, &c.options) == TVI_OK &&
        tvi_integrator_set_parameters(integrator, x->parameter) == TVI_OK) {
        c.status = tvi_step(integrator, c.h, &t, q, p);
        if (x->rescales) q[x->n - 1] = t; /* e is the integrator's own */
        c.q = error_of(x->n, q, exact_q) / unit[0];
        c.p = error_of(x->n - x->rescales, p, exact_p) / unit[1];
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    quad_series_free(&s);
    return c;
}
