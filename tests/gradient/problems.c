/* problems.c - Makes the systems of columns.h, and runs on them. */
#include "columns.h"

#include <math.h>
#include <string.h>

/* ---- The systems ------------------------------------------------------------------------------------------------- */

static jet kepler(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_div(jet_parameter(q[0], 0, 1), jet_hypot(q[0], q[1])));
}

static tvi_system *made(tvi_status status, tvi_system *system)
{
    ck_assert_msg(status == TVI_OK, "%s", tvi_last_error());
    return system;
}

static tvi_system *make_kepler(tvi_system **base)
{
    tvi_system *out = NULL;
    *base = NULL;
    const tvi_status status = tvi_system_potential(&out, 2, NULL, kepler, NULL);
    return made(status, out);
}

static void start_kepler(double q[], double p[])
{
    q[0] = 1, q[1] = 0;
    p[0] = 0, p[1] = 0.8;
}

enum { BODIES = 5, AXES = 3 };
static const double body_mass[BODIES] = {1, 1e-3, 3e-4, 5e-5, 5e-5};

/* Accelerations, so that the masses, which are parameters, are no masses of the system. */
static void bodies(const jet q[], jet t, jet force[], void *ctx)
{
    (void)t, (void)ctx;
    for (int i = 0; i < BODIES * AXES; i++) force[i] = jet_const(0);
    for (int i = 0; i < BODIES; i++)
        for (int k = 0; k < BODIES; k++) {
            if (k == i) continue;
            jet r[AXES];
            for (int a = 0; a < AXES; a++) r[a] = jet_sub(q[AXES * k + a], q[AXES * i + a]);
            const jet pull = jet_mul(jet_parameter(q[0], k, body_mass[k]), jet_pow(jet_dot(r, r, AXES), -1.5));
            for (int a = 0; a < AXES; a++) force[AXES * i + a] = jet_add(force[AXES * i + a], jet_mul(pull, r[a]));
        }
}

static tvi_system *make_bodies(tvi_system **base)
{
    tvi_system *out = NULL;
    *base = NULL;
    const tvi_status status = tvi_system_force(&out, BODIES * AXES, NULL, bodies, NULL);
    return made(status, out);
}

static void start_bodies(double q[], double p[])
{
    memset(q, 0, AXES * sizeof *q);
    memset(p, 0, AXES * sizeof *p);
    for (int i = 1; i < BODIES; i++) {
        const double a = pow(1.6, i - 1), phase = 1.3 * (i - 1), v = 1 / sqrt(a);
        q[AXES * i] = a * cos(phase), q[AXES * i + 1] = a * sin(phase), q[AXES * i + 2] = 0.03 * (i - 1);
        p[AXES * i] = -v * sin(phase), p[AXES * i + 1] = v * cos(phase), p[AXES * i + 2] = 0.02 * v;
    }
}

/* Springs r^2/2 + a r^3/3 + b r^4/4, each with a stiffness of its own. */
enum { MASSES = 16 };
static jet chain(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet V[MASSES + 1];
    const jet a = jet_parameter(q[0], MASSES + 1, 0.25), b = jet_parameter(q[0], MASSES + 2, 0.5);
    for (int i = 0; i <= MASSES; i++) {
        const jet r = i == 0 ? q[0] : i == MASSES ? jet_neg(q[MASSES - 1]) : jet_sub(q[i], q[i - 1]), r2 = jet_sqr(r);
        const jet shape = jet_add(0.5, jet_add(jet_mul(jet_div(a, 3), r), jet_mul(jet_div(b, 4), r2)));
        V[i] = jet_mul(jet_parameter(q[0], i, 1 + 0.05 * sin(i * i)), jet_mul(r2, shape));
    }
    return jet_sum(V, MASSES + 1);
}

static tvi_system *make_chain(tvi_system **base)
{
    tvi_system *out = NULL;
    *base = NULL;
    const tvi_status status = tvi_system_potential(&out, MASSES, NULL, chain, NULL);
    return made(status, out);
}

static void start_chain(double q[], double p[])
{
    for (int i = 0; i < MASSES; i++) q[i] = sin(acos(-1) * (i + 1) / (MASSES + 1)), p[i] = 0;
}

static jet magnetic(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet B = jet_parameter(q[0], 0, 0.7), bent = jet_mul(B, jet_add(0.5, jet_div(jet_sqr(q[0]), 8)));
    const jet v[] = {jet_add(p[0], jet_mul(bent, q[1])), jet_sub(p[1], jet_mul(bent, q[0]))};
    const jet r2 = jet_dot(q, q, 2);
    return jet_add(jet_div(jet_dot(v, v, 2), 2), jet_add(jet_div(r2, 2), jet_div(jet_sqr(r2), 8)));
}

static tvi_system *make_magnetic(tvi_system **base)
{
    tvi_system *out = NULL;
    *base = NULL;
    const tvi_status status = tvi_system_hamiltonian(&out, 2, magnetic, NULL);
    return made(status, out);
}

static void start_magnetic(double q[], double p[])
{
    q[0] = 0.8, q[1] = -0.3;
    p[0] = 0.2, p[1] = 0.6;
}

/* A pendulum with friction and a drive, which is regular. */
static jet pendulum(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_mul(jet_parameter(q[0], 0, 1), jet_cos(q[0])));
}

static void drive(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)ctx;
    const jet push = jet_mul(jet_parameter(q[0], 2, 0.3), jet_cos(jet_mul(0.6, t)));
    force[0] = jet_sub(push, jet_mul(jet_parameter(q[0], 1, 0.05), v[0]));
}

static tvi_system *make_driven(tvi_system **base)
{
    tvi_system *out = NULL;
    tvi_status status = tvi_system_potential(base, 1, NULL, pendulum, NULL);
    if (status == TVI_OK) status = tvi_system_driven(&out, *base, drive, NULL);
    return made(status, out);
}

static void start_driven(double q[], double p[]) { q[0] = 0.5, p[0] = 0.2; }

static jet distance(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_hypot(q[0], q[1]);
}

static tvi_system *make_reversible(tvi_system **base)
{
    tvi_system *out = NULL;
    tvi_status status = tvi_system_potential(base, 2, NULL, kepler, NULL);
    if (status == TVI_OK) status = tvi_system_rescaled_reversible(&out, *base, distance, NULL);
    return made(status, out);
}

/* Henon and Heiles at the energy 1/8, on an orbit whose neighbours leave it by a factor of 1e12 in 1000 steps. */
static jet henon_heiles(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet cubic = jet_mul(q[1], jet_sub(jet_sqr(q[0]), jet_div(jet_sqr(q[1]), 3)));
    return jet_add(jet_div(jet_dot(q, q, 2), 2), jet_mul(jet_parameter(q[0], 0, 1), cubic));
}

static tvi_system *make_chaotic(tvi_system **base)
{
    tvi_system *out = NULL;
    *base = NULL;
    const tvi_status status = tvi_system_potential(&out, 2, NULL, henon_heiles, NULL);
    return made(status, out);
}

static void start_chaotic(double q[], double p[])
{
    q[0] = 0.25, q[1] = 0.375;
    p[0] = 0.1875, p[1] = 0;
}

const columns_problem columns_problems[] = {
    [COLUMNS_KEPLER] = {"Kepler", 2, 0.125, make_kepler, start_kepler},
    [COLUMNS_BODIES] = {"5 bodies", BODIES *AXES, 0.2, make_bodies, start_bodies},
    [COLUMNS_CHAIN] = {"chain", MASSES, 0.5, make_chain, start_chain},
    [COLUMNS_MAGNETIC] = {"magnetic", 2, 0.25, make_magnetic, start_magnetic},
    [COLUMNS_DRIVEN] = {"driven", 1, 0.25, make_driven, start_driven},
    [COLUMNS_REVERSIBLE] = {"reversible", 2, 0.25, make_reversible, start_kepler},
    [COLUMNS_CHAOTIC] = {"chaotic", 2, 0.5, make_chaotic, start_chaotic},
};

jet columns_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_mul(jet_add(1, jet_sqr(q[0])), jet_div(jet_sqr(v[0]), 2)), jet_div(jet_sqr(q[0]), 2));
}

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

void columns_open(columns_run *run, const columns_problem *problem, const char *method, int order)
{
    tvi_options options = tvi_options_default();
    if (method) ck_assert_int_eq(tvi_options_named(method, order, &options), TVI_OK);
    memset(run, 0, sizeof *run);
    run->problem = problem;
    run->n = problem->n;
    run->system = problem->make(&run->base);
    run->rows = 2 * run->n + tvi_system_parameters(run->system);
    ck_assert_int_le(run->rows, COLUMNS_MOST_ROWS);
    ck_assert_int_eq(tvi_integrator_create(&run->it, run->system, &options), TVI_OK);
    problem->start(run->q, run->p);
    for (int i = 0; i < run->rows; i++) run->D[i * run->rows + i] = 1;
}

void columns_close(columns_run *run)
{
    tvi_record_free(run->record);
    tvi_integrator_free(run->it);
    tvi_system_free(run->system);
    tvi_system_free(run->base);
}

void columns_open_pair(columns_run pair[2], const columns_problem *problem, const char *method, int order)
{
    for (int k = 0; k < 2; k++) columns_open(&pair[k], problem, method, order);
}

void columns_close_pair(columns_run pair[2])
{
    for (int k = 0; k < 2; k++) columns_close(&pair[k]);
}

void columns_same_state(const columns_run pair[2])
{
    ck_assert(pair[0].t == pair[1].t && memcmp(pair[0].q, pair[1].q, sizeof pair[0].q) == 0);
    ck_assert(memcmp(pair[0].p, pair[1].p, sizeof pair[0].p) == 0);
}

tvi_run_plan columns_plan(columns_run *run, bool at_once, long steps)
{
    return (tvi_run_plan){
        .h = run->problem->h, .steps = steps, .D = run->D, .columns = run->rows, .columns_at_once = at_once};
}

double columns_distance(int rows, int columns, const double a[], const double b[])
{
    double most = 0;
    for (int c = 0; c < columns; c++) {
        double size = 0, apart = 0;
        for (int i = 0; i < rows; i++) {
            size = fmax(size, fabs(b[i * columns + c]));
            apart = fmax(apart, fabs(a[i * columns + c] - b[i * columns + c]));
            if (isnan(a[i * columns + c]) || isnan(b[i * columns + c])) return NAN; /* which fmax leaves out */
        }
        most = fmax(most, apart == 0 ? 0 : apart / size);
    }
    return most;
}
