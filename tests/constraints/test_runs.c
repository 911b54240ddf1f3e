/* test_runs.c - Tests runs on constraints: forces that press on them, multipliers that change within a step, singular
 * positions, results at times, dense output, an event, energies in long runs. */
#include "constraints.h"
#include "integrator/inside_step.h"

#include <math.h>
#include <string.h>

/* ---- Forces that press on a constraint --------------------------------------------------------------------------- */

static jet nothing(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0, q[0]);
}

static void push(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)v, (void)t;
    force[0] = jet_const(*(const double *)ctx);
    force[1] = jet_const(0.1);
}

static void on_axis(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = q[0];
}

/* A bead on a line: however a force presses across it, the motion along it is the same. Both forms of equations. */
START_TEST(pressed_beads)
{
    static const double presses[] = {1e-6, 1, 3.3, 1e6};
    double press = presses[_i];
    tvi_system *base, *driven, *system;
    ck_assert_int_eq(tvi_system_potential(&base, 2, NULL, nothing, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_driven(&driven, base, push, &press), TVI_OK);
    ck_assert_int_eq(tvi_system_constrained(&system, driven, 1, on_axis, NULL), TVI_OK);
    for (double h = 0.05; h > 1e-3; h /= 5) {
        double t = 0, q[] = {0, 0}, p[] = {0, 1};
        tvi_integrator *integrator = integrator_of_order(system, 16);
        ck_assert_int_eq(tvi_integrate_to(integrator, h, 2, &t, q, p, NULL, NULL), TVI_OK);
        ck_assert_double_eq_tol(q[1], 2.2, 1e-14);
        ck_assert_double_le(fabs(q[0]), 1e-16 * (1 + press));
        tvi_integrator_free(integrator);
    }
    tvi_system_free(system);
    tvi_system_free(driven);
    tvi_system_free(base);
}
END_TEST

/* ---- Multipliers that change within a step ----------------------------------------------------------------------- */

static jet lower_is_heavier(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(9.8, jet_add(q[1], jet_mul(2, q[3])));
}

static void unequal_rods(const jet q[], jet t, jet value[], void *ctx)
{
    const jet d[] = {jet_sub(q[2], q[0]), jet_sub(q[3], q[1])};
    (void)t, (void)ctx;
    value[0] = jet_mul(0.5, jet_sub(jet_dot(q, q, 2), 1));
    value[1] = jet_mul(0.5, jet_sub(jet_dot(d, d, 2), 0.25));
}

/* In the fifteenth step the tension falls to a third. From multipliers extrapolated of the steps before passes find
 * another solution, on the constraints at all nodes, with a tail of 4.7; from the start of the step, the right one. */
START_TEST(a_whip)
{
    const double mass[] = {1, 1, 2, 2};
    tvi_system *base, *system;
    tvi_integrator *integrator;
    double t = 0, q[] = {0.75, -0.6615, 0.637, -0.1744}, p[] = {1.1337, 1.2854, -13.5997, -1.1085}, before, after;
    ck_assert_int_eq(tvi_system_potential(&base, 4, mass, lower_is_heavier, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_constrained(&system, base, 2, unequal_rods, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_project(system, t, q, p), TVI_OK);
    ck_assert_int_eq(tvi_energy(system, t, q, p, &before), TVI_OK);
    ck_assert_int_eq(tvi_integrate(integrator, 0.015, 30, &t, q, p, NULL, NULL), TVI_OK);
    ck_assert_int_eq(tvi_energy(system, t, q, p, &after), TVI_OK);
    ck_assert_double_le(fabs(after - before), 1e-8 * fabs(before));
    ck_assert_double_lt(tvi_integrator_stats(integrator)->largest_tail, 1e-2);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* ---- Singular positions ------------------------------------------------------------------------------------------ */

/* The lines x = 0 and y = 1 of the plane z = 0, which cross: both gradients are along z there. */
static void two_lines(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = q[2];
    value[1] = jet_sub(q[2], jet_mul(q[0], jet_sub(q[1], 1)));
}

/* A step that ends where two constraints depend on each other is refused with their names, and the state stays. Half of
 * it is made. */
START_TEST(singular_positions)
{
    static const char *const methods[] = {"galerkin", "stormer-verlet"};
    tvi_system *base, *system;
    tvi_options options;
    tvi_integrator *integrator;
    double t = 0, q[] = {0, 0.5, 0}, p[] = {0, 1, 0};
    ck_assert_int_eq(tvi_system_potential(&base, 3, NULL, nothing, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_constrained(&system, base, 2, two_lines, NULL), TVI_OK);
    ck_assert_int_eq(tvi_options_named(methods[_i], _i == 0 ? 8 : 2, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    ck_assert_int_eq(tvi_step(integrator, 0.25, &t, q, p), TVI_OK);
    ck_assert_int_eq(tvi_step(integrator, 0.25, &t, q, p), TVI_ESINGULAR);
    ck_assert_ptr_nonnull(strstr(tvi_last_error(), "from t = 0.25: its equations: phi[1] depends on the others"));
    ck_assert(t == 0.25 && q[0] == 0 && q[1] == 0.75 && q[2] == 0 && p[0] == 0 && p[1] == 1 && p[2] == 0);
    ck_assert_int_eq(tvi_step(integrator, 0.125, &t, q, p), TVI_OK);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

typedef struct {
    int n;
    state x;
} seen_state;

static int keep_state(long step, double t, const double q[], const double p[], void *ctx)
{
    seen_state *seen = ctx;
    (void)step;
    seen->x.t = t;
    memcpy(seen->x.q, q, (size_t)seen->n * sizeof *q);
    memcpy(seen->x.p, p, (size_t)seen->n * sizeof *p);
    return 0;
}

/* Results at a time between two steps, and of a run that ends there, are those of steps that fit. */
START_TEST(results_at_times)
{
    const problem *of = &problems[_i];
    tvi_system *system = system_of(of);
    state x = start_of(of, system), to_time = x, end = x;
    seen_state seen = {of->n, x};
    tvi_integrator *integrator = integrator_of_order(system, 16);
    const double when = of->t + 0.173;
    ck_assert_int_eq(tvi_integrate_at(integrator, 0.02, &when, 1, &x.t, x.q, x.p, keep_state, &seen), TVI_OK);
    ck_assert_int_eq(tvi_integrate_to(integrator, 0.02, when, &to_time.t, to_time.q, to_time.p, NULL, NULL), TVI_OK);
    ck_assert_int_eq(make_run(system, 16, 0.173, 9, &end), TVI_OK);
    ck_assert_double_le(distance(of, &seen.x, &end), 1e-12);
    ck_assert_double_le(distance(of, &to_time, &end), 1e-12);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* Inside a step the curve is that of the motion. */
START_TEST(dense_output)
{
    const problem *of = &problems[_i];
    tvi_system *system = system_of(of);
    const state start = start_of(of, system);
    tvi_integrator *integrator = integrator_of_order(system, 16);
    for (double theta = 0; theta <= 1; theta += 0.25) {
        state x = start, inside = start, end = start;
        tvi_integrator_reset(integrator);
        ck_assert_int_eq(tvi_step(integrator, 0.04, &x.t, x.q, x.p), TVI_OK);
        ck_assert_int_eq(tvi_dense(integrator, theta, inside.q, inside.p), TVI_OK);
        if (theta > 0) ck_assert_int_eq(make_run(system, 16, 0.04 * theta, 1, &end), TVI_OK);
        ck_assert_msg(distance(of, &inside, &end) < 1e-9, "%s, theta = %g: %.3g", of->name, theta,
                      distance(of, &inside, &end));
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* Events are searched in states of that curve. */
START_TEST(samples)
{
    const problem *of = &problems[_i];
    const int n = of->n;
    tvi_system *system = system_of(of);
    state x = start_of(of, system), inside = x;
    tvi_integrator *integrator = integrator_of_order(system, 16);
    const tvi_component_range all[] = {{0, n}, {0, n}};
    double sample[(2 * MOST_N + 1) * TVI_SAMPLES];
    ck_assert_int_eq(tvi_step(integrator, 0.04, &x.t, x.q, x.p), TVI_OK);
    tvi_sample_dense_output(integrator, all, sample);
    for (int k = 0; k < TVI_SAMPLES; k++) {
        ck_assert_int_eq(tvi_dense(integrator, tvi_sample_theta[k], inside.q, inside.p), TVI_OK);
        for (int i = 0; i < n; i++) {
            ck_assert_double_eq_tol(sample[i * TVI_SAMPLES + k], inside.q[i], 1e-14);
            ck_assert_double_eq_tol(sample[(n + i) * TVI_SAMPLES + k], inside.p[i], 1e-13);
        }
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

static jet first_coordinate(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_sub(q[0], 0.5);
}

/* The pendulum passes x = 0.5 at times that do not depend on the step, on the constraint. */
START_TEST(events_of_a_pendulum)
{
    const problem *of = &problems[PENDULUM];
    tvi_system *system = system_of(of);
    tvi_event *event;
    double found[2];
    ck_assert_int_eq(tvi_event_create(&event, of->n, TVI_EITHER, true, first_coordinate, NULL), TVI_OK);
    for (int k = 0; k < 2; k++) {
        state x = start_of(of, system);
        double phi, rate;
        tvi_integrator *integrator = integrator_of_order(system, 16);
        const tvi_event *const events[] = {event};
        ck_assert_int_eq(
            tvi_integrate_events(integrator, k ? 0.05 : 0.031, 100, events, 1, &x.t, x.q, x.p, NULL, NULL, NULL),
            TVI_ESTOPPED);
        found[k] = x.t;
        ck_assert_double_eq_tol(x.q[0], 0.5, 1e-14);
        ck_assert_int_eq(tvi_constraint_values(system, x.t, x.q, x.p, &phi, &rate), TVI_OK);
        ck_assert_double_le(fabs(phi), 1e-14);
        ck_assert_double_le(fabs(rate), 1e-13);
        tvi_integrator_free(integrator);
    }
    ck_assert_double_eq_tol(found[0], found[1], 1e-13);
    tvi_event_free(event);
    tvi_system_free(system);
}
END_TEST

/* ---- Long runs --------------------------------------------------------------------------------------------------- */

static jet weight_of_pendulum(const jet q[], jet t, void *ctx)
{
    (void)t;
    return jet_mul(*(const double *)ctx, q[1]);
}

static void unit_rod(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_mul(0.5, jet_sub(jet_dot(q, q, 2), 1));
}

/* The change of a pendulum's energy, in units of its weight. */
static double energy_change(double mass, double speed)
{
    double weight = 9.75 * mass, t = 0, q[] = {1, 0}, p[] = {0, mass * speed}, before, after;
    const double masses[] = {mass, mass};
    tvi_system *base, *system;
    ck_assert_int_eq(tvi_system_potential(&base, 2, masses, weight_of_pendulum, &weight), TVI_OK);
    ck_assert_int_eq(tvi_system_constrained(&system, base, 1, unit_rod, NULL), TVI_OK);
    tvi_integrator *integrator = integrator_of_order(system, 16);
    ck_assert_int_eq(tvi_energy(base, t, q, p, &before), TVI_OK);
    ck_assert_int_eq(tvi_integrate(integrator, 0.05, 60000, &t, q, p, NULL, NULL), TVI_OK);
    ck_assert_int_eq(tvi_energy(base, t, q, p, &after), TVI_OK);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    tvi_system_free(base);
    return (after - before) / weight;
}

/* Energies of 16 pendulums walk at random: their mean is within five of its standard errors. 0.05 * (1 / 0.265) is not
 * 0.05 / 0.265: where one is in the free motion and the other in that of constraints, the mean is at ten and more. */
START_TEST(energies_do_not_drift)
{
    enum { ORBITS = 16 };
    double sum = 0, squares = 0;
    for (int i = 0; i < ORBITS; i++) {
        const double change = energy_change(0.265, 0.5 + 0.01 * i);
        sum += change, squares += change * change;
    }
    const double mean = sum / ORBITS, error = sqrt((squares / ORBITS - mean * mean) / (ORBITS - 1));
    ck_assert_msg(fabs(mean) <= 5 * error, "%.2g +- %.2g", mean, error);
}
END_TEST

Suite *suite_runs(void)
{
    Suite *suite = suite_create("runs");
    TCase *tcase = tcase_create("hard");
    tcase_add_loop_test(tcase, pressed_beads, 0, 4);
    tcase_add_test(tcase, a_whip);
    tcase_add_loop_test(tcase, singular_positions, 0, 2);
    suite_add_tcase(suite, tcase);
    tcase = tcase_create("results");
    tcase_add_loop_test(tcase, results_at_times, 0, problem_count);
    tcase_add_loop_test(tcase, dense_output, 0, problem_count);
    tcase_add_test(tcase, events_of_a_pendulum);
    tcase_add_loop_test(tcase, samples, 0, problem_count);
    suite_add_tcase(suite, tcase);
    tcase = tcase_create("long");
    tcase_add_test(tcase, energies_do_not_drift);
    suite_add_tcase(suite, tcase);
    return suite;
}
