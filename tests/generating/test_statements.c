/* test_statements.c - Tests one problem stated as force, potential, Lagrangian and Hamiltonian: the same motion at the
 * same cost; which Lagrangians and Hamiltonians are recognised as separable; and a force with velocities, which only a
 * Lagrangian states. */
#include "generating.h"
#include "models.h"
#include "statements.h"
#include "system/system.h"

#include <math.h>
#include <stdlib.h>

/* ---- Four statements --------------------------------------------------------------------------------------------- */

enum { FORCE, POTENTIAL, LAGRANGIAN, HAMILTONIAN, STATEMENTS };

/* problem_chain's own force is the fourth statement of the chain. */
static tvi_system *stated(const model *m, int statement)
{
    const bool chain = m == &model_chain;
    tvi_system *system = NULL;
    tvi_status status = TVI_OK;
    switch (statement) {
    case FORCE:
        if (chain) return model_system(m);
        status = tvi_system_force(&system, m->n, NULL, kepler_as_force, NULL);
        break;
    case POTENTIAL:
        status = tvi_system_potential(&system, m->n, chain ? chain_masses : NULL,
                                      chain ? chain_as_potential : kepler_as_potential, NULL);
        break;
    case LAGRANGIAN:
        status = tvi_system_lagrangian(&system, m->n, chain ? chain_as_lagrangian : kepler_as_lagrangian, NULL);
        break;
    default: status = tvi_system_hamiltonian(&system, m->n, chain ? chain_as_hamiltonian : kepler_as_hamiltonian, NULL);
    }
    ck_assert_int_eq(status, TVI_OK);
    return system;
}

static const model *const stated_models[] = {&model_kepler, &model_chain};
enum { STATED = sizeof stated_models / sizeof *stated_models, STATED_STEPS = 60, METHODS = 7 };

static tvi_options stated_options(int method)
{
    static const kind of[] = {
        {TVI_TYPE1, TVI_AT_START, TVI_NODES_TRUNCATED, false},
        {TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true},
        {TVI_TYPE1, TVI_AT_BOTH_ENDS, TVI_NODES_ON_CURVE, true},
        {TVI_TYPE2, TVI_AT_START, TVI_NODES_TRUNCATED, false},
        {TVI_TYPE3, TVI_AT_END, TVI_NODES_ON_CURVE, false},
        {TVI_POINCARE, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true},
    };
    return method < METHODS - 1 ? kind_options(&of[method], 4) : options_verlet();
}

typedef struct {
    test_state end;
    tvi_stats stats;
} stated_run;

static stated_run run_stated(const model *m, int statement, const tvi_options *options)
{
    tvi_system *system = stated(m, statement);
    tvi_integrator *integrator = integrator_of(system, options);
    stated_run run = {.end = model_start(m)};
    go(integrator, m->h, STATED_STEPS, &run.end);
    run.stats = *tvi_integrator_stats(integrator);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return run;
}

START_TEST(statements_agree)
{
    const model *m = stated_models[_i / METHODS];
    const tvi_options options = stated_options(_i % METHODS);
    const stated_run first = run_stated(m, POTENTIAL, &options);
    for (int statement = 0; statement < STATEMENTS; statement++) {
        const stated_run run = run_stated(m, statement, &options);
        const double error = distance(m->n, &run.end, &first.end);
        ck_assert_msg(error < 1e-13, "%s, %s, statement %d: %.1e", m->name, describe(&options), statement, error);
        if (statement == FORCE) continue;
        ck_assert_uint_le(run.stats.bytes, first.stats.bytes);
        ck_assert_int_eq(run.stats.expansions, run.stats.passes + (first.stats.expansions - first.stats.passes));
        ck_assert_int_le(labs(run.stats.passes - first.stats.passes), 3); /* roundoff may decide on a pass */
    }
}
END_TEST

/* The tapes of the field are what a step runs. */
static void check_tape(const jet_tape *tape, const jet_tape *of_potential)
{
    ck_assert_int_eq(tape->slot_count, of_potential->slot_count);
    ck_assert_int_eq(tape->run_count, of_potential->run_count);
}

START_TEST(statements_cost_the_same)
{
    const model *m = stated_models[_i];
    tvi_system *first = stated(m, POTENTIAL);
    for (int statement = POTENTIAL; statement < STATEMENTS; statement++) {
        tvi_system *system = stated(m, statement);
        ck_assert_int_eq(system->form, TVI_SEPARABLE);
        ck_assert_int_eq(system->input_count, m->n);
        ck_assert_int_eq(system->uses_time, m == &model_chain);
        for (int i = 0; i < m->n; i++) ck_assert_double_eq_tol(system->mass[i], problem_mass(m->problem, i), 1e-15);
        check_tape(system->field_series, first->field_series);
        check_tape(system->field_values, first->field_values);
        tvi_system_free(system);
    }
    tvi_system_free(first);
}
END_TEST

/* ---- What is recognised ------------------------------------------------------------------------------------------ */

/* (v0 + v1)^2 + (v0 - v1)^2 = 2 v0^2 + 2 v1^2. */
static jet disguised(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet sum = jet_sqr(jet_add(v[0], v[1])), difference = jet_sqr(jet_sub(v[0], v[1]));
    return jet_sub(jet_add(sum, difference), jet_cos(jet_mul(q[0], q[1])));
}

/* An energy that depends on the time alone moves nothing. */
static jet timed_constant(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)ctx;
    return jet_add(jet_sub(jet_dot(v, v, 2), jet_dot(q, q, 2)), jet_sin(t));
}

static jet position_dependent(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_mul(jet_add(2, jet_cos(q[1])), jet_sqr(v[0])), jet_sqr(v[1]));
}

static jet velocity_linear(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_dot(v, v, 2), jet_mul(q[0], v[1]));
}

static jet off_diagonal(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_add(jet_dot(v, v, 2), jet_mul(v[0], v[1])), jet_dot(q, q, 2));
}

static jet time_dependent(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)ctx;
    return jet_sub(jet_mul(jet_exp(t), jet_dot(v, v, 2)), jet_dot(q, q, 2));
}

/* A force from the time: F = cos t, L_v = v + sin t. */
static jet time_in_momentum(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)ctx;
    return jet_sub(jet_add(jet_mul(0.5, jet_dot(v, v, 2)), jet_mul(jet_sin(t), v[0])), jet_dot(q, q, 2));
}

static jet shifted(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_add(jet_mul(0.5, jet_dot(v, v, 2)), v[0]), jet_dot(q, q, 2));
}

static jet one_negative(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_sub(jet_sqr(v[0]), jet_sqr(v[1])), jet_dot(q, q, 2));
}

static jet quartic(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_add(jet_dot(v, v, 2), jet_pow(v[0], 4)), jet_dot(q, q, 2));
}

static const struct {
    const char *name;
    tvi_lagrangian_fn *function; /* of velocities, or of momenta */
    bool separable;
} statements[] = {
    {"disguised", disguised, true},
    {"timed constant", timed_constant, true},
    {"position-dependent mass", position_dependent, false},
    {"velocity-linear", velocity_linear, false},
    {"off-diagonal mass", off_diagonal, false},
    {"time-dependent mass", time_dependent, false},
    {"time in the momentum", time_in_momentum, false},
    {"shifted momentum", shifted, false},
    {"a negative mass", one_negative, false},
    {"quartic", quartic, false},
};
enum { RECOGNISED = sizeof statements / sizeof *statements };

/* The same function serves as a Lagrangian and as a Hamiltonian. */
START_TEST(structure_is_recognised)
{
    tvi_system *L, *H;
    ck_assert_int_eq(tvi_system_lagrangian(&L, 2, statements[_i].function, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_hamiltonian(&H, 2, statements[_i].function, NULL), TVI_OK);
    ck_assert_msg(L->form == (statements[_i].separable ? TVI_SEPARABLE : TVI_LAGRANGIAN), "%s", statements[_i].name);
    ck_assert_msg(H->form == (statements[_i].separable ? TVI_SEPARABLE : TVI_HAMILTONIAN), "%s", statements[_i].name);
    if (statements[_i].function == disguised)
        for (int i = 0; i < 2; i++) {
            ck_assert_double_eq(L->mass[i], 4);
            ck_assert_double_eq(H->mass[i], 0.25);
        }
    tvi_system_free(L);
    tvi_system_free(H);
}
END_TEST

/* ---- A force with velocities ------------------------------------------------------------------------------------- */

_Static_assert(_Generic((tvi_force_fn *)0, void (*)(const jet *, jet, jet *, void *) : 1, default : 0),
               "a force is given positions and the time, no velocities");

/* m v' = e v x B, B = (-x z, -y z, 1 + z^2) (bench/scenes/magnetic.c); y = (q, v). */
static void lorentz(const double y[6], double out[6])
{
    const double B[] = {-y[0] * y[2], -y[1] * y[2], 1 + y[2] * y[2]}, *v = y + 3;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = v[i];
        out[3 + i] = 1.25 / 0.75 * (v[j] * B[k] - v[k] * B[j]);
    }
}

/* The classical Runge-Kutta method. */
static void runge_kutta(double h, int steps, double y[6])
{
    static const double node[] = {0, 0.5, 0.5, 1}, weight[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    for (int step = 0; step < steps; step++) {
        double slope[6] = {0}, start[6], place[6];
        for (int i = 0; i < 6; i++) start[i] = y[i];
        for (int stage = 0; stage < 4; stage++) {
            for (int i = 0; i < 6; i++) place[i] = start[i] + node[stage] * h * slope[i];
            lorentz(place, slope);
            for (int i = 0; i < 6; i++) y[i] += weight[stage] * h * slope[i];
        }
    }
}

static void no_force(const jet q[], jet t, jet force[], void *ctx)
{
    (void)q, (void)t, (void)ctx;
    for (int i = 0; i < 3; i++) force[i] = jet_const(0);
}

/* The position and velocity to which a method of order 8 brings the charge of velocity v from (1/2, 0, 1/4). */
static void library_run(const tvi_system *system, const double v[], double y[6])
{
    const kind midpoint = {TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true};
    const tvi_options options = kind_options(&midpoint, 4);
    tvi_integrator *integrator = integrator_of(system, &options);
    test_state x = {.q = {0.5, 0, 0.25}};
    ck_assert_int_eq(tvi_momentum(system, 0, x.q, v, x.p), TVI_OK);
    go(integrator, 0.03125, 96, &x);
    for (int i = 0; i < 3; i++) y[i] = x.q[i];
    ck_assert_int_eq(tvi_velocity(system, x.t, x.q, x.p, y + 3), TVI_OK);
    tvi_integrator_free(integrator);
}

START_TEST(magnetic_force_is_lorentz)
{
    static const double mass[] = {0.75, 0.75, 0.75};
    const double v[] = {0.25, 1, 0.5};
    double y[6] = {0.5, 0, 0.25, v[0], v[1], v[2]}, stated_y[6], free_y[6], moved = 0;
    runge_kutta(3.0 / 6000, 6000, y);
    tvi_system *system = model_system(&model_magnetic), *straight;
    ck_assert_int_eq(tvi_system_force(&straight, 3, mass, no_force, NULL), TVI_OK);
    library_run(system, v, stated_y);
    library_run(straight, v, free_y);
    for (int i = 0; i < 6; i++) {
        ck_assert_double_eq_tol(stated_y[i], y[i], 1e-11);
        moved = fmax(moved, fabs(free_y[i] - y[i]));
    }
    ck_assert_double_gt(moved, 0.5);
    tvi_system_free(system);
    tvi_system_free(straight);
}
END_TEST

Suite *suite_statements(void)
{
    Suite *suite = suite_create("statements");
    TCase *tcase = tcase_create("statements");
    tcase_add_loop_test(tcase, statements_agree, 0, STATED * METHODS);
    tcase_add_loop_test(tcase, statements_cost_the_same, 0, STATED);
    tcase_add_loop_test(tcase, structure_is_recognised, 0, RECOGNISED);
    tcase_add_test(tcase, magnetic_force_is_lorentz);
    suite_add_tcase(suite, tcase);
    return suite;
}
