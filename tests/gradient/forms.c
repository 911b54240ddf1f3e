/* forms.c - Makes the systems of gradient.h that columns at once do not serve, or have no need of. */
#include "gradient.h"
#include "scene.h"

#include <math.h>

static tvi_system *made(tvi_status status, tvi_system *system)
{
    ck_assert_msg(status == TVI_OK, "%s", tvi_last_error());
    return system;
}

static tvi_system *make_double_pendulum(tvi_system **base)
{
    tvi_system *out = NULL;
    *base = NULL;
    const tvi_status status = tvi_system_lagrangian(&out, 2, double_pendulum_with_parameters, NULL);
    return made(status, out);
}

static void start_double_pendulum(double q[], double p[])
{
    q[0] = 0.5, q[1] = -0.3;
    p[0] = 0.2, p[1] = 0.1;
}

/* A pendulum whose mass depends on its angle. */
static jet bent(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet mass = jet_add(1, jet_div(jet_sqr(q[0]), 10));
    return jet_add(jet_mul(mass, jet_div(jet_sqr(v[0]), 2)), jet_mul(jet_parameter(q[0], 0, 1), jet_cos(q[0])));
}

static void drive(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)ctx;
    const jet push = jet_mul(jet_parameter(q[0], 2, 0.2), jet_cos(jet_mul(0.9, t)));
    force[0] = jet_sub(push, jet_mul(jet_parameter(q[0], 1, 0.05), v[0]));
}

static tvi_system *make_driven_lagrangian(tvi_system **base)
{
    tvi_system *out = NULL;
    tvi_status status = tvi_system_lagrangian(base, 1, bent, NULL);
    if (status == TVI_OK) status = tvi_system_driven(&out, *base, drive, NULL);
    return made(status, out);
}

static void start_driven_lagrangian(double q[], double p[]) { q[0] = 1.2, p[0] = 0; }

/* Two springs, one of them on a wall that shakes. */
static void shaken(const jet q[], jet t, jet force[], void *ctx)
{
    (void)ctx;
    const jet wall = jet_mul(jet_parameter(q[0], 0, 0.1), jet_sin(jet_mul(jet_parameter(q[0], 1, 0.7), t)));
    force[0] = jet_sub(jet_sub(wall, jet_mul(2, q[0])), jet_mul(0.3, jet_mul(q[0], jet_sqr(q[0]))));
    force[0] = jet_add(force[0], q[1]);
    force[1] = jet_sub(q[0], q[1]);
}

static tvi_system *make_shaken(tvi_system **base)
{
    tvi_system *out = NULL;
    static const double mass[] = {1, 2.5};
    *base = NULL;
    const tvi_status status = tvi_system_force(&out, 2, mass, shaken, NULL);
    return made(status, out);
}

static void start_shaken(double q[], double p[])
{
    q[0] = 0.4, q[1] = -0.1;
    p[0] = 0.1, p[1] = 0.3;
}

static jet kepler(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_div(jet_parameter(q[0], 0, 1), jet_hypot(q[0], q[1])));
}

static jet distance(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_hypot(q[0], q[1]);
}

static tvi_system *make_K(tvi_system **base)
{
    tvi_system *out = NULL;
    tvi_status status = tvi_system_potential(base, 2, NULL, kepler, NULL);
    if (status == TVI_OK) status = tvi_system_rescaled(&out, *base, distance, NULL);
    return made(status, out);
}

static void start_K(double q[], double p[])
{
    q[0] = 1, q[1] = 0;
    p[0] = 0, p[1] = 0.6;
}

const columns_problem *gradient_problem(int i)
{
    static const columns_problem more[] = {
        {"double pendulum", 2, 0.05, make_double_pendulum, start_double_pendulum},
        {"driven Lagrangian", 1, 0.25, make_driven_lagrangian, start_driven_lagrangian},
        {"shaken", 2, 0.25, make_shaken, start_shaken},
        {"K", 2, 0.25, make_K, start_K},
    };
    return i < COLUMNS_PROBLEMS ? &columns_problems[i] : &more[i - COLUMNS_PROBLEMS];
}
