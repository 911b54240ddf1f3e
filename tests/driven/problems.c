/* problems.c - Implements driven.h. */
#include "driven.h"

#include <complex.h>
#include <math.h>

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_div(jet_sqr(q[0]), 2);
}

static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_div(jet_add(jet_sqr(jet_div(p[0], jet_cosh(q[0]))), jet_sqr(jet_sinh(q[0]))), 2);
}

static jet lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_div(jet_sub(jet_sqr(jet_mul(v[0], jet_cosh(q[0]))), jet_sqr(jet_sinh(q[0]))), 2);
}

static tvi_status make_potential(tvi_system **base) { return tvi_system_potential(base, 1, NULL, potential, NULL); }
static tvi_status make_hamiltonian(tvi_system **base) { return tvi_system_hamiltonian(base, 1, hamiltonian, NULL); }
static tvi_status make_lagrangian(tvi_system **base) { return tvi_system_lagrangian(base, 1, lagrangian, NULL); }

/* The force on y at the rate y'. */
static jet force_at(jet rate, jet t)
{
    return jet_sub(jet_mul(AMPLITUDE, jet_cos(jet_mul(OMEGA, t))), jet_mul(2 * FRICTION, rate));
}

static void drive_y(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)ctx;
    force[0] = force_at(v[0], t);
}

/* y' = v cosh x, and the force on x is that on y times dy/dx. */
static void drive_x(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)ctx;
    const jet slope = jet_cosh(q[0]);
    force[0] = jet_mul(slope, force_at(jet_mul(slope, v[0]), t));
}

const form forms[FORMS] = {{"potential", make_potential, drive_y, 0},
                           {"Hamiltonian", make_hamiltonian, drive_x, 1},
                           {"Lagrangian", make_lagrangian, drive_x, 1}};

tvi_system *system_of(const form *as)
{
    tvi_system *base, *driven;
    ck_assert_int_eq(as->make(&base), TVI_OK);
    ck_assert_int_eq(tvi_system_driven(&driven, base, as->drive, NULL), TVI_OK);
    tvi_system_free(base);
    return driven;
}

tvi_integrator *integrator_of(const tvi_system *system, const char *method, int order)
{
    tvi_options options;
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_options_named(method, order, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    return integrator;
}

/* A particular solution, and e^(lambda t) with lambda^2 + 2 c lambda + 1 = 0. */
motion exact(double t)
{
    const double complex swing = AMPLITUDE / (1 - OMEGA * OMEGA + 2 * FRICTION * OMEGA * I);
    const double complex lambda = -FRICTION + I * sqrt(1 - FRICTION * FRICTION), growth = cexp(lambda * t);
    const double y = 1 - creal(swing), rate = creal(-I * OMEGA * swing); /* of the free motion at t = 0 */
    const double slope[2] = {1 / cimag(lambda), -creal(lambda) / cimag(lambda)};
    motion m = {.y = creal(swing * cexp(I * OMEGA * t)), .rate = creal(I * OMEGA * swing * cexp(I * OMEGA * t))};
    const double complex of[2] = {growth * (1 - I * slope[1]), growth * (-I * slope[0])}; /* real parts count */
    for (int k = 0; k < 2; k++) {
        m.by_start[0][k] = creal(of[k]);
        m.by_start[1][k] = creal(lambda * of[k]);
        m.y += m.by_start[0][k] * (k ? rate : y);
        m.rate += m.by_start[1][k] * (k ? rate : y);
    }
    return m;
}

/* y = sinh x, y' = x' cosh x, p = x' cosh^2 x. */
void to_form(const form *as, double y, double rate, double *q, double *p)
{
    *q = as->bends ? asinh(y) : y;
    *p = as->bends ? rate * cosh(*q) : rate;
}

void from_form(const form *as, double q, double p, double *y, double *rate)
{
    *y = as->bends ? sinh(q) : q;
    *rate = as->bends ? p / cosh(q) : p;
}
