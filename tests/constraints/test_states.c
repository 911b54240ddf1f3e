/* test_states.c - Tests what moves a state onto constraints, what tells of it, and the multipliers, against closed
 * forms and differences. */
#include "constraints.h"
#include "problems/refusals.h"

#include <float.h>
#include <math.h>
#include <string.h>

static void expect_close(const char *what, double is, double wanted, double within)
{
    ck_assert_msg(fabs(is - wanted) <= within, "%s: %.17g, not %.17g: off by %.1e, not %.1e", what, is, wanted,
                  fabs(is - wanted), within);
}

/* ---- Projection -------------------------------------------------------------------------------------------------- */

/* On the constraints to roundoff, and there it stays. */
START_TEST(projection_is_on_constraints)
{
    const problem *of = &problems[_i];
    tvi_system *system = system_of(of);
    const state x = start_of(of, system);
    double value[MOST_M], rate[MOST_M], far = 0;
    ck_assert_int_eq(tvi_constraint_values(system, of->t, of->q, of->p, value, rate), TVI_OK);
    for (int k = 0; k < of->m; k++) far = fmax(far, fmax(fabs(value[k]), fabs(rate[k])));
    ck_assert_msg(far > 1e-3, "%s: begins on the constraints", of->name);
    ck_assert_int_eq(tvi_constraint_values(system, of->t, x.q, x.p, value, rate), TVI_OK);
    for (int k = 0; k < of->m; k++) {
        expect_close(of->name, value[k], 0, 16 * DBL_EPSILON);
        expect_close(of->name, rate[k], 0, 32 * DBL_EPSILON);
    }
    state again = x;
    ck_assert_int_eq(tvi_project(system, of->t, again.q, again.p), TVI_OK);
    for (int i = 0; i < of->n; i++) {
        expect_close(of->name, again.q[i], x.q[i], 8 * DBL_EPSILON);
        expect_close(of->name, again.p[i], x.p[i], 32 * DBL_EPSILON);
    }
    tvi_system_free(system);
}
END_TEST

/* Of a pendulum along the rod. */
START_TEST(projection_of_pendulum)
{
    const problem *of = &problems[PENDULUM];
    tvi_system *system = system_of(of);
    const state x = start_of(of, system);
    const double size = hypot(of->q[0], of->q[1]), along[] = {of->q[0] / size, of->q[1] / size};
    const double across = along[0] * of->p[0] + along[1] * of->p[1];
    for (int i = 0; i < 2; i++) {
        expect_close("q", x.q[i], ROD[0] * along[i], 2 * DBL_EPSILON);
        expect_close("p", x.p[i], of->p[i] - across * along[i], 8 * DBL_EPSILON);
    }
    tvi_system_free(system);
}
END_TEST

/* M dq has no part along the constraints, to second order in dq. */
START_TEST(projection_goes_by_masses)
{
    const problem *of = &problems[DOUBLE_PENDULUM];
    tvi_system *system = system_of(of);
    const state x = start_of(of, system);
    double along = 0, moved = 0;
    for (int i = 0; i < 4; i++) {
        const double step = x.q[i] - of->q[i];
        along += step * x.p[i]; /* M dq . v */
        moved += MASS[i / 2] * step * step;
    }
    ck_assert_double_gt(moved, 1e-4);
    ck_assert_double_lt(fabs(along), 2 * moved);
    tvi_system_free(system);
}
END_TEST

/* From far away: a circle from a point a thousand rods out, and from near its centre. */
START_TEST(projection_from_far_away)
{
    tvi_system *system = system_of(&problems[PENDULUM]);
    static const double start[][2] = {{1250, -600}, {1e-3, 2e-3}, {0, 1e150}};
    for (int k = 0; k < 2; k++) {
        double q[] = {start[k][0], start[k][1]}, p[] = {1, 1e6};
        const double size = hypot(q[0], q[1]);
        ck_assert_int_eq(tvi_project(system, 0, q, p), TVI_OK);
        for (int i = 0; i < 2; i++) expect_close("q", q[i], ROD[0] * start[k][i] / size, 4 * DBL_EPSILON);
        expect_close("G v", q[0] * p[0] + q[1] * p[1], 0, 4 * DBL_EPSILON * hypot(p[0], p[1]));
    }
    double q[] = {start[2][0], start[2][1]}, p[] = {1, 1};
    ck_assert_int_ne(tvi_project(system, 0, q, p),
                     TVI_OK); /* phi overflows in a pass, or Newton's method is too slow */
    ck_assert(q[0] == start[2][0] && q[1] == start[2][1] && p[0] == 1 && p[1] == 1);
    tvi_system_free(system);
}
END_TEST

/* A circle about (1e4, 0), in a form whose terms cancel: its roundoff, 1e-8, ends the passes. */
static void cancelling(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_add(jet_sub(jet_dot(q, q, 2), jet_mul(2e4, q[0])), 1e8 - 1);
}

START_TEST(projection_to_roundoff_of_phi)
{
    tvi_system *base = base_of(&problems[PENDULUM]), *system;
    double q[] = {1e4 + 0.6, 0.8}, p[] = {1, 2};
    ck_assert_int_eq(tvi_system_constrained(&system, base, 1, cancelling, NULL), TVI_OK);
    for (int k = 0; k < 20; k++) {
        q[0] += 0.01 * k;
        ck_assert_msg(tvi_project(system, 0, q, p) == TVI_OK, "%s", tvi_last_error());
        expect_close("radius", hypot(q[0] - 1e4, q[1]), 1, 1e-7);
    }
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* ---- Values ------------------------------------------------------------------------------------------------------ */

/* Of a pendulum in closed form; off the constraints, too. */
START_TEST(values_of_pendulum)
{
    const problem *of = &problems[PENDULUM];
    tvi_system *system = system_of(of);
    double value, rate;
    ck_assert_int_eq(tvi_constraint_values(system, 0, of->q, of->p, &value, &rate), TVI_OK);
    expect_close("phi", value, (of->q[0] * of->q[0] + of->q[1] * of->q[1] - ROD[0] * ROD[0]) / 2, 4 * DBL_EPSILON);
    expect_close("rate", rate, (of->q[0] * of->p[0] + of->q[1] * of->p[1]) / MASS[0], 4 * DBL_EPSILON);
    tvi_system_free(system);
}
END_TEST

/* The rates are differences of the values along the motion. */
START_TEST(rates_by_differences)
{
    const problem *of = &problems[_i];
    tvi_system *system = system_of(of);
    static const double weight[] = {1, -8, 0, 8, -1}, h = 1e-3;
    double v[MOST_N], rate[MOST_M], unused[MOST_M], sum[MOST_M] = {0};
    ck_assert_int_eq(tvi_velocity(system, of->t, of->q, of->p, v), TVI_OK);
    ck_assert_int_eq(tvi_constraint_values(system, of->t, of->q, of->p, unused, rate), TVI_OK);
    for (int k = -2; k <= 2; k++) {
        double q[MOST_N], value[MOST_M];
        for (int i = 0; i < of->n; i++) q[i] = of->q[i] + k * h * v[i];
        ck_assert_int_eq(tvi_constraint_values(system, of->t + k * h, q, of->p, value, unused), TVI_OK);
        for (int c = 0; c < of->m; c++) sum[c] += weight[k + 2] * value[c] / (12 * h);
    }
    for (int c = 0; c < of->m; c++) expect_close(of->name, rate[c], sum[c], 1e-10);
    tvi_system_free(system);
}
END_TEST

/* ---- Multipliers ------------------------------------------------------------------------------------------------- */

START_TEST(multiplier_of_pendulum)
{
    const problem *of = &problems[PENDULUM];
    tvi_system *system = system_of(of);
    const state x = start_of(of, system);
    double lambda, force[2];
    ck_assert_int_eq(tvi_multipliers(system, 0, x.q, x.p, &lambda, force), TVI_OK);
    const double m_v2 = (x.p[0] * x.p[0] + x.p[1] * x.p[1]) / MASS[0];
    const double wanted = (m_v2 - MASS[0] * GRAVITY * x.q[1]) / (ROD[0] * ROD[0]);
    expect_close("lambda", lambda, wanted, 8 * DBL_EPSILON * wanted);
    for (int i = 0; i < 2; i++) expect_close("force", force[i], -wanted * x.q[i], 16 * DBL_EPSILON * wanted);
    double alone;
    ck_assert_int_eq(tvi_multipliers(system, 0, x.q, x.p, &alone, NULL), TVI_OK);
    ck_assert(alone == lambda);
    tvi_system_free(system);
}
END_TEST

/* The tensions in the rods of a double pendulum, by the equations of its two bodies along the rods. */
START_TEST(multipliers_of_double_pendulum)
{
    const problem *of = &problems[DOUBLE_PENDULUM];
    tvi_system *system = system_of(of);
    const state x = start_of(of, system);
    double lambda[2];
    ck_assert_int_eq(tvi_multipliers(system, 0, x.q, x.p, lambda, NULL), TVI_OK);
    const double u[] = {x.q[2] - x.q[0], x.q[3] - x.q[1]};
    const double w[] = {x.p[2] / MASS[1] - x.p[0] / MASS[0], x.p[3] / MASS[1] - x.p[1] / MASS[0]};
    const double v2 = (x.p[0] * x.p[0] + x.p[1] * x.p[1]) / (MASS[0] * MASS[0]), u_q = u[0] * x.q[0] + u[1] * x.q[1];
    /* With a = lambda_0, b = 3 lambda_1: q'' = -g + (b u - a q) / m_0, u'' = -b u (1 / m_0 + 1 / m_1) + a q / m_0,
     * q q'' = -v^2, u u'' = -w^2. */
    const double l2 = ROD[0] * ROD[0], r2 = ROD[1] * ROD[1];
    const double A = l2 / MASS[0], B = -u_q / MASS[0], D = r2 * (1 / MASS[0] + 1 / MASS[1]);
    const double first = v2 - GRAVITY * x.q[1], second = w[0] * w[0] + w[1] * w[1], det = A * D - B * B;
    expect_close("lambda[0]", lambda[0], (first * D - B * second) / det, 64 * DBL_EPSILON * fabs(lambda[0]));
    expect_close("lambda[1]", lambda[1], (A * second - B * first) / det / 3, 64 * DBL_EPSILON * fabs(lambda[1]));
    tvi_system_free(system);
}
END_TEST

/* Sets force [n] to -H_q, by differences of the energy, which for a Lagrangian is its p.v - L. */
static void set_force(const problem *of, const tvi_system *system, const state *x, double force[])
{
    static const double weight[] = {1, -8, 0, 8, -1}, h = 1e-3;
    double v[MOST_N];
    ck_assert_int_eq(tvi_velocity(system, of->t, x->q, x->p, v), TVI_OK);
    for (int i = 0; i < of->n; i++) {
        force[i] = 0;
        for (int k = -2; k <= 2 && of->has_energy; k++) {
            double q[MOST_N], H;
            memcpy(q, x->q, sizeof q);
            q[i] += k * h;
            ck_assert_int_eq(tvi_energy(system, of->t, q, x->p, &H), TVI_OK);
            force[i] -= weight[k + 2] * H / (12 * h);
        }
    }
    if (of->add_force) of->add_force(of->t, x->q, v, force);
}

/* With the force of constraint phi'' = 0: the difference of phi' along q' = v, p' = F + force. Without it, phi'' is not
 * 0. */
START_TEST(multipliers_by_differences)
{
    const problem *of = &problems[_i];
    tvi_system *system = system_of(of);
    const state x = start_of(of, system);
    static const double weight[] = {1, -8, 0, 8, -1}, h = 1e-3;
    double v[MOST_N], free_force[MOST_N], force[MOST_N], lambda[MOST_M];
    ck_assert_int_eq(tvi_velocity(system, of->t, x.q, x.p, v), TVI_OK);
    ck_assert_int_eq(tvi_multipliers(system, of->t, x.q, x.p, lambda, force), TVI_OK);
    set_force(of, system, &x, free_force);
    for (int with = 0; with <= 1; with++) {
        double second[MOST_M] = {0}, largest = 0;
        for (int k = -2; k <= 2; k++) {
            state near;
            double value[MOST_M], rate[MOST_M];
            for (int i = 0; i < of->n; i++) {
                near.q[i] = x.q[i] + k * h * v[i];
                near.p[i] = x.p[i] + k * h * (free_force[i] + with * force[i]);
            }
            ck_assert_int_eq(tvi_constraint_values(system, of->t + k * h, near.q, near.p, value, rate), TVI_OK);
            for (int c = 0; c < of->m; c++) second[c] += weight[k + 2] * rate[c] / (12 * h);
        }
        for (int c = 0; c < of->m; c++) largest = fmax(largest, fabs(second[c]));
        ck_assert_msg(with == (largest < 1e-8), "%s: phi'' = %g %s the force of constraint", of->name, largest,
                      with ? "with" : "without");
    }
    tvi_system_free(system);
}
END_TEST

/* Returns the first multiplier at a state of the problem. */
static double multiplier_of(const problem *of)
{
    double lambda[MOST_M];
    tvi_system *system = system_of(of);
    const state x = start_of(of, system);
    ck_assert_int_eq(tvi_multipliers(system, of->t, x.q, x.p, lambda, NULL), TVI_OK);
    tvi_system_free(system);
    return lambda[0];
}

/* L and H of the same motion have the same multipliers, and so have a potential and its force, to the bit. */
START_TEST(multipliers_of_the_same_motion)
{
    int pairs = 0;
    for (int i = 1; i < problem_count; i++) {
        if (!strstr(problems[i].name, "L with")) continue;
        const double of_H = multiplier_of(&problems[i - 1]);
        expect_close(problems[i].name, multiplier_of(&problems[i]), of_H, 1e-13 * fabs(of_H));
        pairs++;
    }
    ck_assert_int_eq(pairs, 2);
    ck_assert(multiplier_of(&problems[PENDULUM]) == multiplier_of(&problems[OF_A_FORCE]));
}
END_TEST

/* ---- Parameters -------------------------------------------------------------------------------------------------- */

/* The potential has parameter 0, the mass times g; phi has parameter 1, the length, and 0, which it leaves out. */
static jet falls(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(jet_parameter(q[0], 0, 10), q[1]);
}

static void rod(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    const jet unused = jet_mul(0, jet_parameter(q[0], 0, 10));
    value[0] = jet_mul(0.5, jet_sub(jet_dot(q, q, 2), jet_add(jet_sqr(jet_parameter(q[0], 1, 2)), unused)));
}

START_TEST(parameters)
{
    tvi_system *base, *system;
    tvi_integrator *it;
    ck_assert_int_eq(tvi_system_potential(&base, 2, NULL, falls, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_constrained(&system, base, 1, rod, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_parameters(base), 1);
    ck_assert_int_eq(tvi_system_parameters(system), 2);
    ck_assert_int_eq(tvi_integrator_create(&it, system, NULL), TVI_OK);
    for (int k = 0; k < 2; k++) { /* the values of the recording, and others */
        const double weight = k ? 20 : 10, length = k ? 3 : 2;
        double q[] = {0.6, -0.8}, p[] = {0.4, 0.3}, value, rate, lambda, force[2];
        if (k) ck_assert_int_eq(tvi_integrator_set_parameters(it, (const double[]){weight, length}), TVI_OK);
        ck_assert_int_eq(tvi_integrator_project(it, 0, q, p), TVI_OK);
        expect_close("length", hypot(q[0], q[1]), length, 2 * DBL_EPSILON * length);
        ck_assert_int_eq(tvi_integrator_constraint_values(it, 0, q, p, &value, &rate), TVI_OK);
        expect_close("phi", value, 0, 8 * DBL_EPSILON);
        ck_assert_int_eq(tvi_integrator_multipliers(it, 0, q, p, &lambda, force), TVI_OK);
        const double wanted = (p[0] * p[0] + p[1] * p[1] - weight * q[1]) / (length * length);
        expect_close("lambda", lambda, wanted, 8 * DBL_EPSILON * wanted);
        expect_close("force", force[0], -lambda * q[0], 8 * DBL_EPSILON * wanted);
    }
    tvi_integrator_free(it);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* ---- States that are refused ------------------------------------------------------------------------------------- */

static jet none(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_dot(q, q, 3);
}

static void redundant(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_sub(jet_add(q[0], q[1]), 1);
    value[1] = jet_mul(1e6, jet_sub(jet_sqr(jet_add(q[0], q[1])), 1));
}

static void contradictory(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_sub(jet_add(q[0], q[1]), 1);
    value[1] = jet_sub(jet_add(q[0], q[1]), 2);
}

/* A circle, and a plane that does not meet it. */
static void apart(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_sub(jet_dot(q, q, 2), 1);
    value[1] = jet_sub(q[0], 3);
}

static void sphere(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_sub(jet_dot(q, q, 3), 1);
}

static void logarithm(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_add(q[1], jet_log(q[0]));
}

static const struct {
    const char *name;
    int m;
    tvi_constraint_fn *phi;
    double q[3];
    tvi_status status;
    const char *culprit;
} cases[] = {
    {"redundant", 2, redundant, {0.5, 0.5, 1}, TVI_ESINGULAR, "phi[1] depends on the others"},
    {"contradictory", 2, contradictory, {0.5, 0.5, 1}, TVI_ESINGULAR, "phi[1] depends on the others"},
    {"apart", 2, apart, {0.5, 0.5, 1}, TVI_ENOCONV, "no coordinates are found"},
    {"no gradient", 1, sphere, {0, 0, 0}, TVI_ESINGULAR, "the gradient of phi[0] is 0: a singular position"},
    {"no value", 1, logarithm, {-1, 0.5, 1}, TVI_EDOMAIN, "phi: jet_log has no power series at -1"},
};

/* The state stays, bit for bit. */
START_TEST(projections_that_are_refused)
{
    tvi_system *base, *system;
    double q[3], p[] = {1, 2, 3};
    memcpy(q, cases[_i].q, sizeof q);
    ck_assert_int_eq(tvi_system_potential(&base, 3, NULL, none, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_constrained(&system, base, cases[_i].m, cases[_i].phi, NULL), TVI_OK);
    expect_refusal(cases[_i].name, tvi_project(system, 0, q, p), cases[_i].status, cases[_i].culprit);
    ck_assert(memcmp(q, cases[_i].q, sizeof q) == 0 && p[0] == 1 && p[1] == 2 && p[2] == 3);
    if (cases[_i].status == TVI_ESINGULAR) {
        double lambda[] = {42, 42}, force[] = {42, 42, 42};
        expect_refusal(cases[_i].name, tvi_multipliers(system, 0, q, p, lambda, force), TVI_ESINGULAR,
                       cases[_i].culprit);
        ck_assert(lambda[0] == 42 && lambda[1] == 42 && force[0] == 42);
    }
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

typedef tvi_status question(const tvi_system *system, double t, double q[], double p[], double a[], double b[]);

static tvi_status ask_project(const tvi_system *system, double t, double q[], double p[], double a[], double b[])
{
    (void)a, (void)b;
    return tvi_project(system, t, q, p);
}

static tvi_status ask_values(const tvi_system *system, double t, double q[], double p[], double a[], double b[])
{
    return tvi_constraint_values(system, t, q, p, a, b);
}

static tvi_status ask_multipliers(const tvi_system *system, double t, double q[], double p[], double a[], double b[])
{
    return tvi_multipliers(system, t, q, p, a, b);
}

static const struct {
    question *ask;
    const char *a, *b;
} questions[] = {{ask_project, NULL, NULL},
                 {ask_values, "value is NULL", "rate is NULL"},
                 {ask_multipliers, "lambda is NULL", NULL}};

START_TEST(arguments_that_are_refused)
{
    question *ask = questions[_i].ask;
    tvi_system *base = base_of(&problems[PENDULUM]), *system = system_of(&problems[PENDULUM]);
    double q[] = {0.75, -1}, p[] = {1, 2}, a[] = {42}, b[] = {42, 42};
    refused("the system has no constraints", ask(base, 0, q, p, a, b), TVI_EUNSUPPORTED);
    refused("system is NULL", ask(NULL, 0, q, p, a, b), TVI_EINVAL);
    refused("q is NULL", ask(system, 0, NULL, p, a, b), TVI_EINVAL);
    refused("p is NULL", ask(system, 0, q, NULL, a, b), TVI_EINVAL);
    if (questions[_i].a) refused(questions[_i].a, ask(system, 0, q, p, NULL, b), TVI_EINVAL);
    if (questions[_i].b) refused(questions[_i].b, ask(system, 0, q, p, a, NULL), TVI_EINVAL);
    refused("t = nan", ask(system, NAN, q, p, a, b), TVI_ENONFINITE);
    refused("q[1] = inf", ask(system, 0, (double[]){0.75, INFINITY}, p, a, b), TVI_ENONFINITE);
    refused("p[0] = nan", ask(system, 0, q, (double[]){NAN, 1}, a, b), TVI_ENONFINITE);
    ck_assert(q[0] == 0.75 && q[1] == -1 && p[0] == 1 && p[1] == 2 && a[0] == 42 && b[0] == 42 && b[1] == 42);
    refused("integrator is NULL", tvi_integrator_project(NULL, 0, q, p), TVI_EINVAL);
    refused("integrator is NULL", tvi_integrator_constraint_values(NULL, 0, q, p, a, b), TVI_EINVAL);
    refused("integrator is NULL", tvi_integrator_multipliers(NULL, 0, q, p, a, b), TVI_EINVAL);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

Suite *suite_states(void)
{
    Suite *suite = suite_create("states");
    TCase *tests = tcase_create("projection");
    tcase_add_loop_test(tests, projection_is_on_constraints, 0, problem_count);
    tcase_add_test(tests, projection_of_pendulum);
    tcase_add_test(tests, projection_goes_by_masses);
    tcase_add_test(tests, projection_from_far_away);
    tcase_add_test(tests, projection_to_roundoff_of_phi);
    tcase_add_loop_test(tests, projections_that_are_refused, 0, (int)(sizeof cases / sizeof *cases));
    suite_add_tcase(suite, tests);
    tests = tcase_create("values");
    tcase_add_test(tests, values_of_pendulum);
    tcase_add_loop_test(tests, rates_by_differences, 0, problem_count);
    tcase_add_loop_test(tests, arguments_that_are_refused, 0, (int)(sizeof questions / sizeof *questions));
    suite_add_tcase(suite, tests);
    tests = tcase_create("multipliers");
    tcase_add_test(tests, multiplier_of_pendulum);
    tcase_add_test(tests, multipliers_of_double_pendulum);
    tcase_add_loop_test(tests, multipliers_by_differences, 0, problem_count);
    tcase_add_test(tests, multipliers_of_the_same_motion);
    tcase_add_test(tests, parameters);
    suite_add_tcase(suite, tests);
    return suite;
}
