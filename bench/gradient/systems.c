/* systems.c - Makes the systems of systems.h. */
#include "systems.h"

#include "experiments/experiment.h"
#include "scene.h"

#include <math.h>

static tvi_system *made(tvi_status status, tvi_system *system)
{
    experiment_insist(status, "a system");
    return system;
}

static jet kepler(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_div(jet_parameter(q[0], 0, 1), jet_hypot(q[0], q[1])));
}

static tvi_system *make_kepler(int n)
{
    tvi_system *out;
    const tvi_status status = tvi_system_potential(&out, n, NULL, kepler, NULL);
    return made(status, out);
}

static jet magnetic(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet B = jet_mul(0.5, jet_parameter(q[0], 0, 1));
    const jet v[] = {jet_add(p[0], jet_mul(B, q[1])), jet_sub(p[1], jet_mul(B, q[0]))};
    return jet_sub(jet_div(jet_dot(v, v, 2), 2), jet_div(1, jet_sqrt(jet_add(1, jet_dot(q, q, 2)))));
}

static tvi_system *make_magnetic(int n)
{
    tvi_system *out;
    const tvi_status status = tvi_system_hamiltonian(&out, n, magnetic, NULL);
    return made(status, out);
}

/* A pendulum with friction and a push that depends on the time. */
static jet pendulum(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_mul(jet_parameter(q[0], 0, 1), jet_cos(q[0])));
}

static void push(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)ctx;
    force[0] = jet_sub(jet_mul(jet_parameter(q[0], 2, 0.2), jet_cos(jet_mul(0.9, t))),
                       jet_mul(jet_parameter(q[0], 1, 0.05), v[0]));
}

static tvi_system *make_friction(int n)
{
    tvi_system *base, *out = NULL;
    tvi_status status = tvi_system_potential(&base, n, NULL, pendulum, NULL);
    if (status == TVI_OK) status = tvi_system_driven(&out, base, push, NULL);
    tvi_system_free(base);
    return made(status, out);
}

enum { AXES = 3 };
static double mass_of_body(int i)
{
    static const double mass[] = {1, 1e-3, 3e-4, 5e-5, 5e-5};
    return i < 5 ? mass[i] : 1e-5;
}

/* Accelerations of bodies whose masses are parameters. ctx is their number. */
static void bodies(const jet q[], jet t, jet force[], void *ctx)
{
    const int count = *(const int *)ctx;
    (void)t;
    for (int i = 0; i < AXES * count; i++) force[i] = jet_const(0);
    for (int i = 0; i < count; i++)
        for (int j = 0; j < i; j++) {
            jet r[AXES];
            for (int d = 0; d < AXES; d++) r[d] = jet_sub(q[AXES * j + d], q[AXES * i + d]);
            const jet cubed = jet_pow(jet_dot(r, r, AXES), -1.5);
            const jet on_i = jet_mul(jet_parameter(q[0], j, mass_of_body(j)), cubed);
            const jet on_j = jet_mul(jet_parameter(q[0], i, mass_of_body(i)), cubed);
            for (int d = 0; d < AXES; d++) {
                force[AXES * i + d] = jet_add(force[AXES * i + d], jet_mul(on_i, r[d]));
                force[AXES * j + d] = jet_sub(force[AXES * j + d], jet_mul(on_j, r[d]));
            }
        }
}

static tvi_system *make_bodies(int n)
{
    tvi_system *out;
    int count = n / AXES;
    const tvi_status status = tvi_system_force(&out, n, NULL, bodies, &count);
    return made(status, out);
}

/* A chain of n springs r^2/2 + a r^3/3 + b r^4/4, each with a stiffness of its own. ctx is n. */
static jet chain(const jet q[], jet t, void *ctx)
{
    const int n = *(const int *)ctx;
    jet V[GRADIENT_MOST + 1];
    (void)t;
    const jet a = jet_parameter(q[0], n + 1, 0.25), b = jet_parameter(q[0], n + 2, 0.5);
    for (int i = 0; i <= n; i++) {
        const jet r = i == 0 ? q[0] : i == n ? jet_neg(q[n - 1]) : jet_sub(q[i], q[i - 1]), r2 = jet_sqr(r);
        const jet shape = jet_add(0.5, jet_add(jet_mul(jet_div(a, 3), r), jet_mul(jet_div(b, 4), r2)));
        V[i] = jet_mul(jet_parameter(q[0], i, 1 + 0.05 * sin(i * i)), jet_mul(r2, shape));
    }
    return jet_sum(V, n + 1);
}

static tvi_system *make_chain(int n)
{
    tvi_system *out;
    const tvi_status status = tvi_system_potential(&out, n, NULL, chain, &n);
    return made(status, out);
}

static tvi_system *make_double_pendulum(int n)
{
    tvi_system *out;
    const tvi_status status = tvi_system_lagrangian(&out, n, double_pendulum_with_parameters, NULL);
    return made(status, out);
}

gradient_system gradient_systems[GRADIENT_SYSTEMS] = {
    [GRADIENT_KEPLER] = {"Kepler", 2, 0.25, make_kepler, {1, 0}, {0, 0.8}},
    [GRADIENT_MAGNETIC] = {"magnetic field", 2, 0.2, make_magnetic, {1, 0}, {0, 0.6}},
    [GRADIENT_FRICTION] = {"pendulum with friction", 1, 0.25, make_friction, {1.5}, {0}},
    [GRADIENT_FIVE_BODIES] = {"5 bodies", 5 * AXES, 0.4, make_bodies, {0}, {0}},
    [GRADIENT_EIGHT_BODIES] = {"8 bodies", 8 * AXES, 0.4, make_bodies, {0}, {0}},
    [GRADIENT_TWELVE_BODIES] = {"12 bodies", 12 * AXES, 0.4, make_bodies, {0}, {0}},
    [GRADIENT_FPUT] = {"FPUT of 64", 64, 0.5, make_chain, {0}, {0}},
    [GRADIENT_DOUBLE_PENDULUM] = {"double pendulum", 2, 0.05, make_double_pendulum, {0.5, -0.3}, {0.2, 0.1}},
};

/* Circles around the first body. */
static void place_bodies(gradient_system *of)
{
    for (int i = 1; i < of->n / AXES; i++) {
        const double a = pow(1.6, i - 1), phase = 1.3 * (i - 1), v = 1 / sqrt(a);
        double *q = of->q + AXES * i, *p = of->p + AXES * i;
        q[0] = a * cos(phase), q[1] = a * sin(phase), q[2] = 0.03 * (i - 1);
        p[0] = -v * sin(phase), p[1] = v * cos(phase), p[2] = 0.02 * v;
    }
}

void gradient_systems_begin(void)
{
    for (int i = GRADIENT_FIVE_BODIES; i <= GRADIENT_TWELVE_BODIES; i++) place_bodies(&gradient_systems[i]);
    gradient_system *fput = &gradient_systems[GRADIENT_FPUT];
    for (int i = 0; i < fput->n; i++) fput->q[i] = sin(acos(-1) * (i + 1) / (fput->n + 1));
}
