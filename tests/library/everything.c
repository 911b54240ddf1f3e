/* everything.c - Creates systems with every operation, and the ways to make a step. */
#include "everything.h"

/* ---- Functions with every operation, and more nodes than one piece of a recording holds -------------------------- */

enum { TERMS = 16 };

/* Every function where it exists, for |x| < 1. */
static int every_function(jet x, jet y[])
{
    int count = 0;
    y[count++] = jet_add(x, 1);
    y[count++] = jet_sub(0.5, x);
    y[count++] = jet_neg(x);
    y[count++] = jet_sqr(jet_add(x, 2));
    y[count++] = jet_div(jet_add(1, x), jet_add(3, x));
    y[count++] = jet_div(2, jet_add(3, x));
    y[count++] = jet_sqrt(jet_add(2, x));
    y[count++] = jet_pow(jet_add(2, x), -1.5);
    y[count++] = jet_pow(jet_add(2, x), 7);
    y[count++] = jet_pow(jet_add(2, x), -3);
    y[count++] = jet_log(jet_add(2, x));
    y[count++] = jet_asin(jet_mul(0.5, x));
    y[count++] = jet_acos(jet_mul(0.25, x));
    y[count++] = jet_acosh(jet_add(2, x));
    y[count++] = jet_atanh(jet_mul(0.25, x));
    y[count++] = jet_atan2(x, jet_add(2, x));
    y[count++] = jet_hypot(2, x);
    static const jet_function everywhere[] = {JET_EXP,  JET_SIN,  JET_COS,  JET_TAN,   JET_ATAN,
                                              JET_SINH, JET_COSH, JET_TANH, JET_ASINH, JET_ERF};
    for (size_t i = 0; i < sizeof everywhere / sizeof *everywhere; i++)
        y[count++] = jet_record_function(everywhere[i], jet_mul(0.5, x));
    return count;
}

/* The sum over all functions f of f(q_i) f(q_j) / 1000, and TERMS products that are all different; with a context,
 * less: the sum of f(q_0) / 1000 and |q|^2/2, for steps that shall not take long. */
static jet everything(const jet q[], jet t, void *ctx)
{
    jet y[N][32], term[TERMS];
    int count = 0;
    for (int i = 0; i < N; i++) count = every_function(q[i], y[i]);
    if (ctx) return jet_add(jet_mul(1e-3, jet_sum(y[0], count)), jet_mul(0.5, jet_dot(q, q, N)));
    for (int i = 0; i < TERMS; i++)
        term[i] =
            jet_mul(jet_mul(1e-3, q[i % N]), jet_add(i + 1, jet_mul(q[(i + 1) % N], jet_sin(jet_mul(1e-3 * i, t)))));
    const jet dots = jet_add(jet_dot(y[0], y[1], count), jet_dot(y[1], y[2], count));
    return jet_add(jet_mul(1e-3, dots), jet_sum(term, TERMS));
}

static void everything_force(const jet q[], jet t, jet force[], void *ctx)
{
    force[0] = everything(q, t, ctx);
    force[1] = jet_const(0.25);
    force[2] = jet_neg(jet_mul(force[0], q[2]));
}

/* L and H with a mass that is not constant: M(q) = 1 + q_i^2. */
static jet everything_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    jet term[N];
    for (int i = 0; i < N; i++) term[i] = jet_mul(jet_add(1, jet_sqr(q[i])), jet_sqr(v[i]));
    return jet_sub(jet_mul(0.5, jet_sum(term, N)), everything(q, t, ctx));
}

static jet everything_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    jet term[N];
    for (int i = 0; i < N; i++) term[i] = jet_div(jet_sqr(p[i]), jet_add(1, jet_sqr(q[i])));
    return jet_add(jet_mul(0.5, jet_sum(term, N)), everything(q, t, ctx));
}

/* L and H that are seen to be separable. */
static jet separable_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return jet_sub(jet_dot(v, v, N), everything(q, t, ctx));
}

static jet separable_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    return jet_add(jet_dot(p, p, N), everything(q, t, ctx));
}

static const double mass[N] = {1, 2, 0.5};

static jet slower_far_away(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(1, jet_mul(0.5, jet_add(jet_dot(q, q, N), jet_mul(p[0], q[1]))));
}

/* A potential rescaled by K, or a Hamiltonian in the reversible form. The light one has the automatic time scale. */
static tvi_status rescale(statement by, tvi_system **out, void *ctx)
{
    tvi_system *base;
    tvi_status status = state_everything(by == REVERSIBLE ? HAMILTONIAN : POTENTIAL, &base, ctx);
    tvi_rescale_fn *g = ctx ? NULL : slower_far_away;
    *out = NULL;
    if (status != TVI_OK) return status;
    status =
        by == REVERSIBLE ? tvi_system_rescaled_reversible(out, base, g, NULL) : tvi_system_rescaled(out, base, g, NULL);
    tvi_system_free(base);
    return status;
}

/* Every operation on the curve x - y = -0.1, to first order about it; of the light one no other than products. */
static void on_curve(const jet q[], jet t, jet value[], void *ctx)
{
    jet y[32];
    const jet off = jet_add(jet_sub(q[0], q[1]), 0.1), square = jet_sqr(off);
    const int count = every_function(q[2], y);
    value[0] = jet_add(off, ctx ? square : jet_mul(jet_mul(square, jet_sum(y, count)), jet_add(1, jet_mul(1e-3, t))));
}

static tvi_status constrain(tvi_system **out, void *ctx)
{
    tvi_system *base;
    tvi_status status = state_everything(POTENTIAL, &base, ctx);
    *out = NULL;
    if (status != TVI_OK) return status;
    status = tvi_system_constrained(out, base, 1, on_curve, ctx);
    tvi_system_free(base);
    return status;
}

tvi_status state_everything(statement by, tvi_system **out, void *ctx)
{
    switch (by) {
    case FORCE: return tvi_system_force(out, N, mass, everything_force, ctx);
    case POTENTIAL: return tvi_system_potential(out, N, mass, everything, ctx);
    case LAGRANGIAN: return tvi_system_lagrangian(out, N, everything_lagrangian, ctx);
    case HAMILTONIAN: return tvi_system_hamiltonian(out, N, everything_hamiltonian, ctx);
    case RESCALED:
    case REVERSIBLE: return rescale(by, out, ctx);
    case CONSTRAINED: return constrain(out, ctx);
    case SEPARABLE_L: return tvi_system_lagrangian(out, N, separable_lagrangian, ctx);
    default: return tvi_system_hamiltonian(out, N, separable_hamiltonian, ctx);
    }
}

tvi_system *create_everything(statement by, bool light)
{
    tvi_system *system;
    ck_assert_int_eq(state_everything(by, &system, light ? &light : NULL), TVI_OK);
    return system;
}

/* ---- The ways to make a step ------------------------------------------------------------------------------------- */

const way ways[] = {
    {"tvi", 1, TVI_RECTANGLE_START, 0, false, POTENTIAL},
    {"tvi", 2, TVI_TRAPEZOID, 0, false, POTENTIAL},
    {"tvi", 5, TVI_QUADRATURE_AUTO, 0, false, FORCE},
    {"start", 4, TVI_LOBATTO, 0, false, POTENTIAL},
    {"start", 8, TVI_QUADRATURE_AUTO, 2, false, LAGRANGIAN},
    {"end", 6, TVI_QUADRATURE_AUTO, 0, true, HAMILTONIAN},
    {"midpoint", 2, TVI_QUADRATURE_AUTO, 0, false, POTENTIAL},
    {"midpoint", 6, TVI_LOBATTO, 3, false, POTENTIAL},
    {"midpoint", 12, TVI_QUADRATURE_AUTO, 0, false, SEPARABLE_L},
    {"midpoint", 8, TVI_QUADRATURE_AUTO, 0, false, LAGRANGIAN},
    {"midpoint", 6, TVI_QUADRATURE_AUTO, TVI_PREDICT_ONLY, false, HAMILTONIAN},
    {"both-ends", 6, TVI_QUADRATURE_AUTO, 0, false, POTENTIAL},
    {"both-ends", 4, TVI_QUADRATURE_AUTO, 0, false, LAGRANGIAN},
    {"symmetric-tvi", 2, TVI_QUADRATURE_AUTO, 0, false, HAMILTONIAN},
    {"right", 6, TVI_QUADRATURE_AUTO, 0, false, SEPARABLE_H},
    {"left", 6, TVI_QUADRATURE_AUTO, 0, false, HAMILTONIAN},
    {"htvi-right", 3, TVI_QUADRATURE_AUTO, 0, false, HAMILTONIAN},
    {"htvi-left", 4, TVI_QUADRATURE_AUTO, 0, true, POTENTIAL},
    {"svhd", 2, TVI_TRAPEZOID, 0, true, POTENTIAL},
    {"poincare", 8, TVI_QUADRATURE_AUTO, 0, false, POTENTIAL},
    {"poincare", 4, TVI_QUADRATURE_AUTO, 0, false, HAMILTONIAN},
    {"galerkin", 16, TVI_QUADRATURE_AUTO, 0, false, POTENTIAL},
    {"galerkin", 6, TVI_GAUSS, 0, false, HAMILTONIAN},
    {"galerkin", 10, TVI_QUADRATURE_AUTO, 0, false, LAGRANGIAN},
    {"galerkin", 20, TVI_QUADRATURE_AUTO, 3, true, SEPARABLE_H},
    {"taylor", 7, TVI_QUADRATURE_AUTO, 0, false, POTENTIAL},
    {"taylor", 5, TVI_QUADRATURE_AUTO, 0, false, LAGRANGIAN},
    {"stormer-verlet", 2, TVI_QUADRATURE_AUTO, 0, false, FORCE},
    {"galerkin", 8, TVI_QUADRATURE_AUTO, 0, false, RESCALED},
    {"right", 4, TVI_QUADRATURE_AUTO, 0, true, RESCALED},
    {"taylor", 5, TVI_QUADRATURE_AUTO, 0, false, RESCALED},
    {"galerkin", 8, TVI_QUADRATURE_AUTO, 0, false, REVERSIBLE},
};
const int way_count = sizeof ways / sizeof *ways;

tvi_options options_of_way(int which)
{
    tvi_options options;
    ck_assert_int_eq(tvi_options_named(ways[which].name, ways[which].order, &options), TVI_OK);
    options.quadrature = ways[which].quadrature;
    options.passes = ways[which].passes;
    options.compose_adjoint = ways[which].compose_adjoint;
    return options;
}
