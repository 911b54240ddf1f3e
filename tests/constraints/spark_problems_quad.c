/* spark_problems_quad.c - States problems on constraints in closed form and for the library (spark_quad.h). */
#include "spark_quad.h"

#include <quadmath.h>

/* ---- A double pendulum of unequal masses, with a force that is no weight ----------------------------------------- */

static jet double_potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet weight = jet_mul(9.75, jet_add(jet_mul(2, q[1]), jet_mul(0.25, q[3])));
    return jet_add(weight, jet_mul(1.5, jet_cos(jet_mul(2, q[2]))));
}

static tvi_status make_double(tvi_system **base)
{
    return tvi_system_potential(base, 4, (const double[]){2, 2, 0.25, 0.25}, double_potential, NULL);
}

static jet square(jet x, jet y) { return jet_add(jet_sqr(x), jet_sqr(y)); }

/* The second one is in a unit of its own. */
static void double_phi(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_mul(0.5, jet_sub(square(q[0], q[1]), 1.25 * 1.25));
    value[1] = jet_mul(1.5, jet_sub(square(jet_sub(q[2], q[0]), jet_sub(q[3], q[1])), 0.75 * 0.75));
}

static void double_slopes(quad t, const quad q[], const quad p[], quad Hq[], quad Hp[], quad *W)
{
    static const quad gravity = 9.75;
    (void)t, (void)W;
    Hq[0] = 0, Hq[1] = 2 * gravity, Hq[2] = -3 * sinq(2 * q[2]), Hq[3] = gravity / 4;
    Hp[0] = p[0] / 2, Hp[1] = p[1] / 2, Hp[2] = 4 * p[2], Hp[3] = 4 * p[3];
}

static void double_constrain(quad t, const quad q[], quad phi[], quad *G, quad phi_t[])
{
    const quad x = q[2] - q[0], y = q[3] - q[1];
    (void)t;
    phi[0] = (q[0] * q[0] + q[1] * q[1] - 1.5625) / 2;
    phi[1] = 1.5 * (x * x + y * y - 0.5625);
    G[0] = q[0], G[1] = q[1], G[2] = G[3] = 0;
    G[4] = -3 * x, G[5] = -3 * y, G[6] = 3 * x, G[7] = 3 * y;
    phi_t[0] = phi_t[1] = 0;
}

/* ---- A pendulum with a moving pivot, at (sin(2 t) / 4, 0) -------------------------------------------------------- */

static jet pendulum_potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(2 * 9.75, q[1]);
}

static tvi_status make_pendulum(tvi_system **base)
{
    return tvi_system_potential(base, 2, (const double[]){2, 2}, pendulum_potential, NULL);
}

static void pivot_phi(const jet q[], jet t, jet value[], void *ctx)
{
    (void)ctx;
    const jet x = jet_sub(q[0], jet_mul(0.25, jet_sin(jet_mul(2, t))));
    value[0] = jet_mul(0.5, jet_sub(square(x, q[1]), 1.25 * 1.25));
}

static void pendulum_slopes(quad t, const quad q[], const quad p[], quad Hq[], quad Hp[], quad *W)
{
    (void)t, (void)q, (void)W;
    Hq[0] = 0, Hq[1] = 19.5;
    Hp[0] = p[0] / 2, Hp[1] = p[1] / 2;
}

static void pivot_constrain(quad t, const quad q[], quad phi[], quad *G, quad phi_t[])
{
    const quad x = q[0] - sinq(2 * t) / 4;
    phi[0] = (x * x + q[1] * q[1] - 1.5625) / 2;
    G[0] = x, G[1] = q[1];
    phi_t[0] = -x * cosq(2 * t) / 2;
}

/* ---- A bead on a wire, y = sin(2 x) and z = x y exp(x) / 2, in a potential --------------------------------------- */

static jet bead_potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_mul(1.5, q[1]), jet_sqr(jet_sqr(q[2])));
}

static tvi_status make_bead(tvi_system **base)
{
    return tvi_system_potential(base, 3, (const double[]){1, 0.5, 4}, bead_potential, NULL);
}

static void wire_phi(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_sub(q[1], jet_sin(jet_mul(2, q[0])));
    value[1] = jet_sub(q[2], jet_mul(0.5, jet_mul(jet_mul(q[0], q[1]), jet_exp(q[0]))));
}

static void bead_slopes(quad t, const quad q[], const quad p[], quad Hq[], quad Hp[], quad *W)
{
    (void)t, (void)W;
    Hq[0] = 0, Hq[1] = 1.5, Hq[2] = 4 * q[2] * q[2] * q[2];
    Hp[0] = p[0], Hp[1] = 2 * p[1], Hp[2] = p[2] / 4;
}

static void wire_constrain(quad t, const quad q[], quad phi[], quad *G, quad phi_t[])
{
    const quad half = expq(q[0]) / 2;
    (void)t;
    phi[0] = q[1] - sinq(2 * q[0]);
    phi[1] = q[2] - q[0] * q[1] * half;
    G[0] = -2 * cosq(2 * q[0]), G[1] = 1, G[2] = 0;
    G[3] = -(1 + q[0]) * q[1] * half, G[4] = -q[0] * half, G[5] = 1;
    phi_t[0] = phi_t[1] = 0;
}

/* ---- Masses of q and t, with the moving pivot -------------------------------------------------------------------- */

/* H = (c |p|^2 / 2 - p_0 p_1 / 4) / (c^2 - 1/16) + 19.5 y, c = 1 + (2 + sin t) x^2 / 4: the masses (c, 1/4; 1/4, c). */
static jet bent_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    const jet c = jet_add(1, jet_mul(jet_mul(0.25, jet_add(2, jet_sin(t))), jet_sqr(q[0])));
    const jet above = jet_sub(jet_mul(jet_mul(0.5, c), jet_dot(p, p, 2)), jet_mul(0.25, jet_mul(p[0], p[1])));
    return jet_add(jet_div(above, jet_sub(jet_sqr(c), 0.0625)), pendulum_potential(q, t, ctx));
}

static tvi_status make_bent(tvi_system **base) { return tvi_system_hamiltonian(base, 2, bent_hamiltonian, NULL); }

static void bent_slopes(quad t, const quad q[], const quad p[], quad Hq[], quad Hp[], quad *W)
{
    const quad c = 1 + (2 + sinq(t)) * q[0] * q[0] / 4, below = c * c - 0.0625, squares = p[0] * p[0] + p[1] * p[1];
    const quad above = c * squares / 2 - p[0] * p[1] / 4;
    Hq[0] = (squares / 2 - 2 * c * above / below) / below * (2 + sinq(t)) * q[0] / 2;
    Hq[1] = 19.5;
    Hp[0] = (c * p[0] - p[1] / 4) / below, Hp[1] = (c * p[1] - p[0] / 4) / below;
    if (W) W[0] = W[3] = c / below, W[1] = W[2] = -0.25 / below;
}

const spark_problem spark_problems[] = {
    {.name = "double pendulum",
     .n = 4,
     .m = 2,
     .is_separable = true,
     .masses = {2, 2, 0.25, 0.25},
     .q = {0.75, -1, 1.2, -1.6},
     .p = {2, 1.5, -0.3, 0.1},
     .slopes = double_slopes,
     .constrain = double_constrain,
     .make = make_double,
     .phi = double_phi},
    {.name = "moving pivot",
     .n = 2,
     .m = 1,
     .is_separable = true,
     .masses = {2, 2},
     .t = 0.375,
     .q = {0.9, -1.01},
     .p = {2, 1.5},
     .slopes = pendulum_slopes,
     .constrain = pivot_constrain,
     .make = make_pendulum,
     .phi = pivot_phi},
    {.name = "bead on a wire",
     .n = 3,
     .m = 2,
     .is_separable = true,
     .masses = {1, 0.5, 4},
     .q = {0.3, 0.57, 0.12},
     .p = {0.5, 0.5, 0.5},
     .slopes = bead_slopes,
     .constrain = wire_constrain,
     .make = make_bead,
     .phi = wire_phi},
    {.name = "masses of q and t",
     .n = 2,
     .m = 1,
     .t = 0.375,
     .q = {0.9, -1.01},
     .p = {0.6, 0.4},
     .slopes = bent_slopes,
     .constrain = pivot_constrain,
     .make = make_bent,
     .phi = pivot_phi},
};
const int spark_problem_count = sizeof spark_problems / sizeof *spark_problems;
