/* problems.c - Implements ensemble.h. */
#include "ensemble.h"

#include <math.h>
#include <string.h>

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet a = jet_parameter(q[0], 0, 1);
    const jet cubic = jet_sub(jet_mul(a, jet_mul(jet_sqr(q[0]), q[1])), jet_div(jet_pow(q[1], 3), 3));
    return jet_add(jet_mul(0.5, jet_dot(q, q, N)), cubic);
}

static jet mass(jet x) { return jet_add(1, jet_div(jet_sqr(x), 8)); }

static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    return jet_add(jet_div(jet_dot(p, p, N), jet_mul(2, mass(q[0]))), potential(q, t, ctx));
}

static jet lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return jet_sub(jet_mul(jet_mul(0.5, mass(q[0])), jet_dot(v, v, N)), potential(q, t, ctx));
}

static void force(const jet q[], jet t, jet F[], void *ctx)
{
    (void)ctx;
    const jet a = jet_parameter(q[0], 0, 1), push = jet_mul(0.01, jet_cos(t));
    F[0] = jet_sub(push, jet_add(q[0], jet_mul(jet_mul(2, a), jet_mul(q[0], q[1]))));
    F[1] = jet_sub(jet_sub(jet_sqr(q[1]), q[1]), jet_mul(a, jet_sqr(q[0])));
}

static void friction(const jet q[], const jet v[], jet t, jet F[], void *ctx)
{
    (void)q, (void)t, (void)ctx;
    for (int i = 0; i < N; i++) F[i] = jet_mul(-0.01, v[i]);
}

static tvi_status make_potential(tvi_system **out) { return tvi_system_potential(out, N, NULL, potential, NULL); }

static tvi_status make_force(tvi_system **out) { return tvi_system_force(out, N, (const double[]){1, 2}, force, NULL); }

static tvi_status make_hamiltonian(tvi_system **out) { return tvi_system_hamiltonian(out, N, hamiltonian, NULL); }
static tvi_status make_lagrangian(tvi_system **out) { return tvi_system_lagrangian(out, N, lagrangian, NULL); }

static tvi_status make_rescaled(tvi_system **out)
{
    tvi_system *base;
    tvi_status status = make_potential(&base);
    if (status == TVI_OK) status = tvi_system_rescaled(out, base, NULL, NULL);
    tvi_system_free(base);
    return status;
}

static tvi_status make_driven(tvi_system **out)
{
    tvi_system *base;
    tvi_status status = make_potential(&base);
    if (status == TVI_OK) status = tvi_system_driven(out, base, friction, NULL);
    tvi_system_free(base);
    return status;
}

const form forms[] = {{"potential", make_potential},   {"force", make_force},       {"hamiltonian", make_hamiltonian},
                      {"lagrangian", make_lagrangian}, {"rescaled", make_rescaled}, {"driven", make_driven}};
const int form_count = sizeof forms / sizeof *forms;

const method methods[] = {{"galerkin", 16}, {"galerkin", 4}, {"taylor", 12},   {"stormer-verlet", 2},
                          {"midpoint", 8},  {"poincare", 6}, {"both-ends", 6}, {"right", 4}};
const int method_count = sizeof methods / sizeof *methods;

tvi_system *system_of(const form *as)
{
    tvi_system *system = NULL;
    ck_assert_msg(as->make(&system) == TVI_OK, "%s: %s", as->name, tvi_last_error());
    return system;
}

bool has_options(const tvi_system *system, const method *by, tvi_options *options)
{
    ck_assert_int_eq(tvi_options_named(by->name, by->order, options), TVI_OK);
    return tvi_options_check(system, options, NULL) == TVI_OK;
}

/* ---- Members ----------------------------------------------------------------------------------------------------- */

/* A number in [0, 1) that no other orbit has. */
static double part(int orbit, double irrational)
{
    const double x = (orbit + 1) * irrational;
    return x - floor(x);
}

double value_of(int orbit) { return 0.75 + 0.5 * part(orbit, 0.3247179572447461); }

static void start_orbit(int orbit, double q[], double p[], size_t stride)
{
    q[0] = 0.25 * part(orbit, 0.7548776662466927) - 0.125;
    q[stride] = 0.25 * part(orbit, 0.5698402909980532) - 0.125;
    p[0] = 0.25 * part(orbit, 0.8191725133961645);
    p[stride] = 0.25 * part(orbit, 0.6710436067037893);
}

/* A column of the state, and one of the parameter. */
static void start_columns(double D[], size_t stride)
{
    for (int k = 0; k < ROWS * COLUMNS; k++) D[(size_t)k * stride] = 0;
    D[0] = 1;
    D[(size_t)((ROWS - 1) * COLUMNS + 1) * stride] = 1;
}

void start_group(group *c, int members, int first)
{
    c->members = members;
    for (int m = 0; m < members; m++) {
        c->t[m] = 0;
        start_orbit(first + m, c->q + m, c->p + m, (size_t)members);
        start_columns(c->D + m, (size_t)members);
        c->status[m] = TVI_ENOMEM; /* which no run leaves there */
    }
}

void set_values(tvi_ensemble *ensemble, int members, int first)
{
    double value[MOST];
    for (int m = 0; m < members; m++) value[m] = value_of(first + m);
    OK(tvi_ensemble_set_parameters(ensemble, value));
}

static bool same_rows(const double *x, int a, int of, const double *y, int b, int and_of, int rows)
{
    bool is_same = true;
    for (int i = 0; i < rows; i++) is_same = is_same && memcmp(&x[i * of + a], &y[i * and_of + b], sizeof *x) == 0;
    return is_same;
}

void expect_same(const char *what, const group *x, int a, const group *y, int b)
{
    const int of = x->members, and_of = y->members;
    const bool is_same = same_rows(x->t, a, of, y->t, b, and_of, 1) && same_rows(x->q, a, of, y->q, b, and_of, N) &&
                         same_rows(x->p, a, of, y->p, b, and_of, N) &&
                         same_rows(x->D, a, of, y->D, b, and_of, ROWS * COLUMNS);
    ck_assert_msg(is_same, "%s: member %d of %d is not member %d of %d: apart by %g", what, a, of, b, and_of,
                  distance(x, a, y, b));
    ck_assert_msg(x->status[a] == y->status[b], "%s: member %d of %d: %s", what, a, of,
                  tvi_status_string(x->status[a]));
}

double distance(const group *x, int a, const group *y, int b)
{
    double most = fabs(x->t[a] - y->t[b]);
    for (int i = 0; i < N; i++) {
        most = fmax(most, fabs(x->q[i * x->members + a] - y->q[i * y->members + b]));
        most = fmax(most, fabs(x->p[i * x->members + a] - y->p[i * y->members + b]));
    }
    return most;
}

alone start_alone(const tvi_system *system, const tvi_options *options, int orbit)
{
    alone a = {0};
    const double value = value_of(orbit);
    OK(tvi_integrator_create(&a.integrator, system, options));
    OK(tvi_integrator_set_parameters(a.integrator, &value));
    start_orbit(orbit, a.q, a.p, 1);
    start_columns(a.D, 1);
    return a;
}

void end_alone(alone *a) { tvi_integrator_free(a->integrator); }

group *group_of(const alone *a, group *c)
{
    c->members = 1;
    c->status[0] = TVI_OK;
    c->t[0] = a->t;
    memcpy(c->q, a->q, sizeof a->q);
    memcpy(c->p, a->p, sizeof a->p);
    memcpy(c->D, a->D, sizeof a->D);
    return c;
}
