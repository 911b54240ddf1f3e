/* problems.c - Implements parameters.h. */
#include "parameters.h"

#include <math.h>

static jet number(jet of_recording, int index, const double *numbers)
{
    return numbers ? jet_const(numbers[index]) : jet_parameter(of_recording, index, recorded[index]);
}

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t;
    const jet k = number(q[0], 0, ctx), m = number(q[0], 1, ctx), square = jet_add(jet_sqr(q[0]), jet_sqr(q[1]));
    const jet smooth = jet_add(jet_div(jet_sqr(square), 8), jet_mul(m, jet_mul(jet_sqr(q[0]), q[1])));
    return jet_sub(smooth, jet_div(k, jet_sqrt(square)));
}

/* A kinetic energy that no diagonal constant mass makes, (1 + m y^2) (a^2 + b^2) / 2. */
static jet kinetic(const jet q[], const jet a[], void *ctx)
{
    const jet m = number(q[0], 1, ctx);
    return jet_div(jet_mul(jet_add(1, jet_mul(m, jet_sqr(q[1]))), jet_add(jet_sqr(a[0]), jet_sqr(a[1]))), 2);
}

static jet lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return jet_sub(kinetic(q, v, ctx), potential(q, t, ctx));
}

static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    return jet_add(kinetic(q, p, ctx), potential(q, t, ctx));
}

static tvi_status make_potential(tvi_system **system, const double *numbers)
{
    return tvi_system_potential(system, N, NULL, potential, (void *)numbers);
}

static tvi_status make_lagrangian(tvi_system **system, const double *numbers)
{
    return tvi_system_lagrangian(system, N, lagrangian, (void *)numbers);
}

static tvi_status make_hamiltonian(tvi_system **system, const double *numbers)
{
    return tvi_system_hamiltonian(system, N, hamiltonian, (void *)numbers);
}

/* g = r^(3/2) / k. */
static jet scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t;
    return jet_exp(jet_sub(jet_mul(1.5, jet_log(jet_hypot(q[0], q[1]))), number(q[0], 0, ctx)));
}

static tvi_status make_rescaled(tvi_system **system, const double *numbers)
{
    tvi_system *base;
    tvi_status status = make_potential(&base, numbers);
    if (status == TVI_OK) status = tvi_system_rescaled(system, base, scale, (void *)numbers);
    tvi_system_free(base);
    return status;
}

const form forms[FORMS] = {{"potential", make_potential},
                           {"Lagrangian", make_lagrangian},
                           {"Hamiltonian", make_hamiltonian},
                           {"rescaled", make_rescaled}};

const method methods[METHODS] = {{"galerkin", 16}, {"midpoint", 8}, {"right", 8}, {"poincare", 8},
                                 {"taylor", 12},   {"tvi", 4},      {"left", 6},  {"stormer-verlet", 2}};

tvi_system *system_of(const form *as, const double *numbers)
{
    tvi_system *system;
    ck_assert_int_eq(as->make(&system, numbers), TVI_OK);
    ck_assert_int_eq(tvi_system_parameters(system), numbers ? 0 : PARAMETERS);
    return system;
}

tvi_integrator *integrator_of(const tvi_system *system, const method *by)
{
    tvi_options options;
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_options_named(by->name, by->order, &options), TVI_OK);
    const tvi_status status = tvi_integrator_create(&integrator, system, &options);
    ck_assert(status == TVI_OK || (status == TVI_EUNSUPPORTED && !integrator));
    return integrator;
}

state run(tvi_integrator *integrator, int steps)
{
    state x = start;
    ck_assert_int_eq(tvi_integrate(integrator, H, steps, &x.t, x.q, x.p, NULL, NULL), TVI_OK);
    return x;
}

double distance(const state *a, const state *b)
{
    double most = fabs(a->t - b->t);
    for (int i = 0; i < N; i++) most = fmax(most, fmax(fabs(a->q[i] - b->q[i]), fabs(a->p[i] - b->p[i])));
    return most;
}
