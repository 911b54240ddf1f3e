/* problems.c - Implements rescaled.h. */
#include "rescaled.h"
#include "scenes/hard.h"
#include "system/system.h"

#include <math.h>

jet kepler(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_dot(q, q, 2), -0.5));
}

jet kepler_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_pow(jet_dot(q, q, 2), 0.75);
}

const double driven_mass[2] = {1, 2.5};

jet driven(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    const jet xx = jet_sqr(q[0]), yy = jet_sqr(q[1]), k = jet_add(1, jet_mul(0.5, jet_cos(t)));
    const jet square = jet_add(jet_add(xx, jet_mul(2, yy)), jet_mul(q[0], q[1]));
    return jet_add(jet_mul(jet_mul(0.5, k), square), jet_add(jet_mul(0.25, jet_sqr(xx)), jet_mul(xx, q[1])));
}

jet driven_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)ctx;
    const jet sum = jet_add(jet_add(1, jet_sqr(q[0])), jet_mul(0.25, jet_add(jet_sqr(p[1]), jet_sin(t))));
    return jet_div(1, sum);
}

state kepler_start(double e) { return (state){0, {1 - e, 0}, {0, sqrt((1 + e) / (1 - e))}}; }

state kepler_at(double e, double t)
{
    const long double E = kepler_anomaly(e, t), b = sqrtl(1 - (long double)e * e), rate = 1 / (1 - e * cosl(E));
    return (state){
        t, {(double)(cosl(E) - e), (double)(b * sinl(E))}, {(double)(-sinl(E) * rate), (double)(b * cosl(E) * rate)}};
}

state driven_start(void) { return (state){0.3, {0.6, -0.4}, {0.2, 0.7}}; }

double state_distance(int n, const state *a, const state *b)
{
    double most = fabs(a->t - b->t);
    for (int i = 0; i < n; i++) most = fmax(most, fmax(fabs(a->q[i] - b->q[i]), fabs(a->p[i] - b->p[i])));
    return most;
}

tvi_system *rescaled_system(int n, const double mass[], tvi_potential_fn *potential, tvi_rescale_fn *g)
{
    tvi_system *base, *rescaled;
    ck_assert_int_eq(tvi_system_potential(&base, n, mass, potential, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_rescaled(&rescaled, base, g, NULL), TVI_OK);
    tvi_system_free(base);
    return rescaled;
}

tvi_system *rescaled_hamiltonian(int n, tvi_hamiltonian_fn *H, void *ctx)
{
    tvi_system *base, *rescaled;
    ck_assert_int_eq(tvi_system_hamiltonian(&base, n, H, ctx), TVI_OK);
    ck_assert_int_eq(tvi_system_rescaled(&rescaled, base, NULL, NULL), TVI_OK);
    tvi_system_free(base);
    return rescaled;
}

double scale_at(const tvi_system *rescaled, const state *x)
{
    const int n = tvi_system_dimension(rescaled);
    double q[MOST_N + 1], p[MOST_N + 1], v[MOST_N + 1], H;
    for (int i = 0; i < n; i++) q[i] = x->q[i], p[i] = x->p[i];
    ck_assert_int_eq(tvi_energy(rescaled, x->t, x->q, x->p, &H), TVI_OK);
    q[n] = x->t, p[n] = -H;
    ck_assert_int_eq(tvi_velocity(rescaled->stepped_system, 0, q, p, v), TVI_OK);
    return v[n];
}

run open_run(tvi_system *system, const char *method, int order, const state *start)
{
    run r = {.system = system, .x = *start};
    tvi_options options = tvi_options_default();
    if (method) ck_assert_int_eq(tvi_options_named(method, order, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&r.integrator, system, &options), TVI_OK);
    return r;
}

run open_kepler(double e, tvi_rescale_fn *g, const char *method, int order)
{
    const state start = kepler_start(e);
    return open_run(rescaled_system(2, NULL, kepler, g), method, order, &start);
}

void close_run(run *r)
{
    tvi_integrator_free(r->integrator);
    tvi_system_free(r->system);
}

tvi_status run_steps(run *r, double h, long steps)
{
    return tvi_integrate(r->integrator, h, steps, &r->x.t, r->x.q, r->x.p, NULL, NULL);
}

const served all_served[] = {
    {"galerkin", 2, false}, {"galerkin", 4, false}, {"galerkin", 6, false},   {"poincare", 2, false},
    {"poincare", 4, false}, {"right", 2, false},    {"right", 4, false},      {"left", 4, false},
    {"right", 4, true},     {"left", 6, false},     {"htvi-right", 2, false}, {"htvi-left", 4, false},
    {"taylor", 3, false},   {"taylor", 5, false},
};

tvi_options options_of(const served *method)
{
    tvi_options options;
    ck_assert_int_eq(tvi_options_named(method->name, method->order, &options), TVI_OK);
    options.compose_adjoint = method->composed;
    return options;
}
