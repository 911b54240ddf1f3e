/* problems.c - States the constrained systems of constraints.h. */
#include "constraints.h"

#include <math.h>
#include <string.h>

/* ---- Constraints ------------------------------------------------------------------------------------------------- */

/* (|x - y|^2 - l^2) / 2 in the plane; y NULL: the origin. */
static jet rod(const jet x[], const jet y[], double length)
{
    const jet a = y ? jet_sub(x[0], y[0]) : x[0], b = y ? jet_sub(x[1], y[1]) : x[1];
    return jet_mul(0.5, jet_sub(jet_add(jet_sqr(a), jet_sqr(b)), length * length));
}

static void one_rod(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = rod(q, NULL, ROD[0]);
}

static void two_rods(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = rod(q, NULL, ROD[0]);
    value[1] = jet_mul(3, rod(q + 2, q, ROD[1])); /* in a unit of its own */
}

/* The pivot is at (0.25 sin 2t, 0). */
static void moving_pivot(const jet q[], jet t, jet value[], void *ctx)
{
    const jet pivot[] = {jet_mul(0.25, jet_sin(jet_mul(2, t))), jet_const(0)};
    (void)ctx;
    value[0] = rod(q, pivot, ROD[0]);
}

/* A line that moves to the side: phi_t is a number. */
static void moving_line(const jet q[], jet t, jet value[], void *ctx)
{
    (void)ctx;
    value[0] = jet_sub(jet_add(q[0], jet_mul(0.25, q[1])), jet_mul(0.5, t));
}

static void wire(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_sub(q[1], jet_sin(jet_mul(2, q[0])));
}

/* A curve in space: z = x y, and x^2 + y^2 + z^4 = 1. */
static void curve(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_sub(q[2], jet_mul(q[0], q[1]));
    value[1] = jet_sub(jet_add(jet_add(jet_sqr(q[0]), jet_sqr(q[1])), jet_pow(q[2], 4)), 1);
}

/* ---- Systems ----------------------------------------------------------------------------------------------------- */

static jet falls(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(MASS[0] * GRAVITY, q[1]);
}

static jet both_fall(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(GRAVITY, jet_add(jet_mul(MASS[0], q[1]), jet_mul(MASS[1], q[3])));
}

static void weight(const jet q[], jet t, jet force[], void *ctx)
{
    (void)q, (void)t, (void)ctx;
    force[0] = jet_const(0);
    force[1] = jet_const(-MASS[0] * GRAVITY);
}

static void add_weight(double t, const double q[], const double v[], double force[])
{
    (void)t, (void)q, (void)v;
    force[1] -= MASS[0] * GRAVITY;
}

static void wind(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)ctx;
    force[0] = jet_sub(jet_sin(t), jet_mul(0.3, v[0]));
    force[1] = jet_mul(-0.3, jet_mul(v[1], v[0]));
}

static void add_wind(double t, const double q[], const double v[], double force[])
{
    (void)q;
    force[0] += sin(t) - 0.3 * v[0];
    force[1] += -0.3 * v[1] * v[0];
}

/* c(q, t), with the masses (c, 0.2; 0.2, c), which depend on both. */
static jet bent(const jet q[], jet t)
{
    return jet_add(1, jet_mul(jet_mul(0.3, jet_add(2, jet_sin(t))), jet_sqr(q[0])));
}

static jet bent_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    const jet c = bent(q, t), squares = jet_mul(jet_mul(0.5, c), jet_dot(p, p, 2));
    const jet kinetic = jet_div(jet_sub(squares, jet_mul(0.2, jet_mul(p[0], p[1]))), jet_sub(jet_sqr(c), 0.04));
    return jet_add(kinetic, falls(q, t, ctx));
}

static jet bent_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    const jet kinetic = jet_add(jet_mul(jet_mul(0.5, bent(q, t)), jet_dot(v, v, 2)), jet_mul(0.2, jet_mul(v[0], v[1])));
    return jet_sub(kinetic, falls(q, t, ctx));
}

/* H_pp depends on p. */
static jet fast_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    return jet_add(jet_sqrt(jet_add(1, jet_dot(p, p, 2))), falls(q, t, ctx));
}

static jet fast_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return jet_sub(jet_neg(jet_sqrt(jet_sub(1, jet_dot(v, v, 2)))), falls(q, t, ctx));
}

/* p = M v + f(q, t) in a magnetic field and a rotating frame, with the masses 2, 3, 0.5. */
static jet turning_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    const jet kinetic_energy =
        jet_add(jet_sqr(v[0]), jet_add(jet_mul(1.5, jet_sqr(v[1])), jet_mul(0.25, jet_sqr(v[2]))));
    const jet turning = jet_mul(jet_cos(t), jet_sub(jet_mul(q[0], v[1]), jet_mul(jet_sqr(q[1]), v[0])));
    (void)ctx;
    return jet_sub(jet_add(kinetic_energy, turning), jet_mul(q[2], q[0]));
}

static tvi_status make_falling(tvi_system **base)
{
    return tvi_system_potential(base, 2, (const double[]){MASS[0], MASS[0]}, falls, NULL);
}

static tvi_status make_both(tvi_system **base)
{
    return tvi_system_potential(base, 4, (const double[]){MASS[0], MASS[0], MASS[1], MASS[1]}, both_fall, NULL);
}

static tvi_status make_weight(tvi_system **base)
{
    return tvi_system_force(base, 2, (const double[]){MASS[0], MASS[0]}, weight, NULL);
}

static tvi_status make_driven(tvi_system **base)
{
    tvi_system *falling;
    tvi_status status = make_falling(&falling);
    if (status == TVI_OK) status = tvi_system_driven(base, falling, wind, NULL);
    tvi_system_free(falling);
    return status;
}

static tvi_status make_bent(tvi_system **base) { return tvi_system_hamiltonian(base, 2, bent_hamiltonian, NULL); }
static tvi_status make_bent_L(tvi_system **base) { return tvi_system_lagrangian(base, 2, bent_lagrangian, NULL); }
static tvi_status make_fast(tvi_system **base) { return tvi_system_hamiltonian(base, 2, fast_hamiltonian, NULL); }
static tvi_status make_fast_L(tvi_system **base) { return tvi_system_lagrangian(base, 2, fast_lagrangian, NULL); }
static tvi_status make_turning(tvi_system **base) { return tvi_system_lagrangian(base, 3, turning_lagrangian, NULL); }

const problem problems[] = {
    [PENDULUM] = {"pendulum", 2, 1, make_falling, one_rod, 0, {0.75, -1.01}, {2, 1.5}, NULL, 1},
    [DOUBLE_PENDULUM] =
        {"double pendulum", 4, 2, make_both, two_rods, 0, {0.75, -1.01, 1.2, -1.6}, {2, 1.5, -0.3, 0.1}, NULL, 1},
    [OF_A_FORCE] = {"pendulum of a force", 2, 1, make_weight, one_rod, 0, {0.75, -1.01}, {2, 1.5}, add_weight, 0},
    [BENT] = {"masses of q and t", 2, 1, make_bent, moving_pivot, 0.4, {0.9, -1.01}, {0.6, 0.4}, NULL, 1},
    {"L with masses of q and t", 2, 1, make_bent_L, moving_pivot, 0.4, {0.9, -1.01}, {0.6, 0.4}, NULL, 1},
    {"driven pendulum", 2, 1, make_driven, one_rod, 0.4, {0.75, -1.01}, {2, 1.5}, add_wind, 1},
    {"moving pivot", 2, 1, make_falling, moving_pivot, 0.4, {0.9, -1.01}, {2, 1.5}, NULL, 1},
    {"moving line", 2, 1, make_falling, moving_line, 0.4, {0.46, -1.01}, {1.1, 1.5}, NULL, 1},
    {"bead on a wire", 2, 1, make_falling, wire, 0, {0.3, 0.57}, {1, 1.5}, NULL, 1},
    {"masses of p", 2, 1, make_fast, one_rod, 0, {0.75, -1.01}, {0.6, 0.4}, NULL, 1},
    {"L with masses of v", 2, 1, make_fast_L, one_rod, 0, {0.75, -1.01}, {0.6, 0.4}, NULL, 1},
    {"turning frame on a curve", 3, 2, make_turning, curve, 0.4, {0.8, 0.6, 0.47}, {0.3, 0.5, 0.2}, NULL, 1},
};
const int problem_count = sizeof problems / sizeof *problems;

tvi_system *base_of(const problem *of)
{
    tvi_system *base;
    ck_assert_msg(of->make(&base) == TVI_OK, "%s: %s", of->name, tvi_last_error());
    return base;
}

tvi_system *system_of(const problem *of)
{
    tvi_system *base = base_of(of), *system;
    const tvi_status status = tvi_system_constrained(&system, base, of->m, of->phi, NULL);
    ck_assert_msg(status == TVI_OK, "%s: %s", of->name, tvi_last_error());
    tvi_system_free(base);
    return system;
}

state start_of(const problem *of, const tvi_system *system)
{
    state x = {.t = of->t};
    memcpy(x.q, of->q, sizeof x.q);
    memcpy(x.p, of->p, sizeof x.p);
    const tvi_status status = tvi_project(system, x.t, x.q, x.p);
    ck_assert_msg(status == TVI_OK, "%s: %s", of->name, tvi_last_error());
    return x;
}

tvi_integrator *integrator_of_order(const tvi_system *system, int order)
{
    tvi_options options;
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_options_named("galerkin", order, &options), TVI_OK);
    options.max_tail = -1;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    return integrator;
}

/* The state after `steps` steps to the time `duration`. */
tvi_status make_run(const tvi_system *system, int order, double duration, long steps, state *x)
{
    tvi_integrator *integrator = integrator_of_order(system, order);
    const tvi_status status = tvi_integrate(integrator, duration / (double)steps, steps, &x->t, x->q, x->p, NULL, NULL);
    tvi_integrator_free(integrator);
    return status;
}

double distance(const problem *of, const state *x, const state *y)
{
    double most = 0;
    for (int i = 0; i < of->n; i++) {
        const double in_q = fabs(x->q[i] - y->q[i]), in_p = fabs(x->p[i] - y->p[i]);
        if (isnan(in_q) || isnan(in_p)) return NAN; /* which fmax leaves out */
        most = fmax(most, fmax(in_q, in_p));
    }
    return most;
}
