/* test_second.c - Tests second derivatives times a vector: gradients of runs of the tangent system. */
#include "gradient.h"

#include "problems/refusals.h"
#include "system/energy.h"
#include "tvi_gradient.h"
#include "tvi_runs.h"

#include <math.h>
#include <string.h>

enum { STEPS = 40, TIMES = 3, MOST_VALUES = 2 * COLUMNS_MOST_N + COLUMNS_MOST_PARAMETERS };

/* The loss is sum_k |x(t_k) - d|^2 / 2 at some times and at the end, x = (q, p), with some data d. */
static double datum(int i) { return 0.3 * sin(1.7 * i); }

static const int forms[] = {COLUMNS_KEPLER,
                            COLUMNS_CHAIN,
                            COLUMNS_MAGNETIC,
                            COLUMNS_DRIVEN,
                            GRADIENT_DOUBLE_PENDULUM,
                            GRADIENT_DRIVEN_LAGRANGIAN,
                            GRADIENT_TIME};

/* A run of the tangent system with a record; n and parameters are those of the system itself. */
typedef struct {
    const columns_problem *problem;
    tvi_system *system, *base, *tangent;
    tvi_integrator *it;
    tvi_record *record;
    int n, parameters;
    bool is_lagrangian; /* its momenta are (dp, p) */
    double q[COLUMNS_MOST_N], p[COLUMNS_MOST_N], c[COLUMNS_MOST_PARAMETERS];
} second_run;

static void open_run(second_run *run, int which)
{
    columns_run of;
    tvi_options options;
    columns_open(&of, gradient_problem(which), "galerkin", 16);
    *run = (second_run){.problem = of.problem, .system = of.system, .base = of.base, .n = of.n};
    memcpy(run->q, of.q, sizeof run->q);
    memcpy(run->p, of.p, sizeof run->p);
    tvi_integrator_free(of.it);
    run->parameters = tvi_system_parameters(run->system);
    tvi_system_recorded_parameters(run->system, run->c);
    run->is_lagrangian = run->system->form == TVI_LAGRANGIAN;
    ck_assert_int_eq(tvi_system_tangent(&run->tangent, run->system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_parameters(run->tangent), 2 * run->parameters);
    ck_assert_int_eq(tvi_options_named("galerkin", 16, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&run->it, run->tangent, &options), TVI_OK);
    ck_assert_int_eq(tvi_record_create(&run->record, run->it, 0), TVI_OK);
}

static void close_run(second_run *run)
{
    tvi_record_free(run->record);
    tvi_integrator_free(run->it);
    tvi_system_free(run->tangent);
    tvi_system_free(run->system);
    tvi_system_free(run->base);
}

/* The derivatives of m = l_x.dx by what a state (x, dx) of the tangent system tells; both are [4n]. */
static void set_loss(const second_run *run, const double q[], const double p[], double by[])
{
    const int n = run->n, of_p = run->is_lagrangian ? n : 0, of_dp = n - of_p;
    for (int i = 0; i < n; i++) {
        by[i] = q[n + i];
        by[n + i] = q[i] - datum(i);
        by[2 * n + of_p + i] = p[of_dp + i];
        by[2 * n + of_dp + i] = p[of_p + i] - datum(n + i);
    }
}

/* What is told at the times, as losses. */
typedef struct {
    const second_run *run;
    double *at_times;
} told;

static int tell(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    const told *to = ctx;
    (void)member, (void)t;
    set_loss(to->run, q, p, to->at_times + 4 * to->run->n * (which - 1));
    return 0;
}

/* Computes the gradient and l'' v, [2n + parameters] each, by q, p and c. */
static void multiply(const second_run *run, const double v[], double gradient[], double product[])
{
    const int n = run->n, P = run->parameters, of_p = run->is_lagrangian ? n : 0, of_dp = n - of_p;
    const double h = run->problem->h, end = STEPS * h, times[TIMES] = {0.21 * end, 0.5 * end, 0.93 * end};
    double t = 0, q[2 * COLUMNS_MOST_N], p[2 * COLUMNS_MOST_N], c[2 * COLUMNS_MOST_PARAMETERS];
    double at_times[TIMES * 4 * COLUMNS_MOST_N], at_end[4 * COLUMNS_MOST_N + 1] = {0};
    double by_start[4 * COLUMNS_MOST_N + 1], by_c[2 * COLUMNS_MOST_PARAMETERS];
    for (int i = 0; i < n; i++) {
        q[i] = run->q[i], q[n + i] = v[i];
        p[of_p + i] = run->p[i], p[of_dp + i] = v[n + i];
    }
    for (int i = 0; i < P; i++) c[i] = run->c[i], c[P + i] = v[2 * n + i];
    if (P > 0) ck_assert_int_eq(tvi_integrator_set_parameters(run->it, c), TVI_OK);
    told to = {run, at_times};
    const tvi_run_plan plan = {.h = h,
                               .has_t_end = true,
                               .t_end = end,
                               .times = times,
                               .time_count = TIMES,
                               .at_time = tell,
                               .ctx = &to,
                               .record = run->record,
                               .size = sizeof plan};
    tvi_integrator_reset(run->it);
    ck_assert_msg(tvi_run(run->it, &plan, &t, q, p) == TVI_OK, "%s: %s", run->problem->name, tvi_last_error());
    set_loss(run, q, p, at_end);
    const tvi_loss loss = {.end = at_end, .at_times = at_times, .size = sizeof loss};
    ck_assert_msg(tvi_gradient(run->record, &loss, by_start, by_c) == TVI_OK, "%s", tvi_last_error());
    for (int i = 0; i < n; i++) {
        product[i] = by_start[i], gradient[i] = by_start[n + i];
        product[n + i] = by_start[2 * n + of_p + i], gradient[n + i] = by_start[2 * n + of_dp + i];
    }
    for (int i = 0; i < P; i++) product[2 * n + i] = by_c[i], gradient[2 * n + i] = by_c[P + i];
}

/* l'' is symmetric, which no part of the computation knows; it is that of differences of gradients; and the derivative
 * of m by dx is the gradient, the same for each v. */
START_TEST(symmetric_and_as_by_differences)
{
    static double H[MOST_VALUES][MOST_VALUES];
    double v[MOST_VALUES], gradient[MOST_VALUES], other[MOST_VALUES], ignored[MOST_VALUES], largest = 0;
    second_run run;
    open_run(&run, forms[_i]);
    const int values = 2 * run.n + run.parameters;
    for (int k = 0; k < values; k++) {
        for (int i = 0; i < values; i++) v[i] = i == k;
        multiply(&run, v, k ? other : gradient, H[k]);
        for (int i = 0; i < values && k; i++)
            ck_assert_double_eq_tol(other[i], gradient[i], 1e-12 * (1 + fabs(gradient[i])));
        for (int i = 0; i < values; i++) largest = fmax(largest, fabs(H[k][i]));
    }
    for (int k = 0; k < values; k++)
        for (int i = 0; i < k; i++)
            ck_assert_msg(fabs(H[k][i] - H[i][k]) <= 1e-11 * largest, "%s: %d, %d: %.17g, %.17g of %g",
                          run.problem->name, k, i, H[k][i], H[i][k], largest);
    for (int k = 0; k < values; k++) {
        double *const x = k < run.n ? &run.q[k] : k < 2 * run.n ? &run.p[k - run.n] : &run.c[k - 2 * run.n];
        const double kept = *x, d = 1e-5 * (1 + fabs(kept));
        *x = kept + d;
        multiply(&run, v, other, ignored);
        *x = kept - d;
        multiply(&run, v, gradient, ignored);
        *x = kept;
        for (int i = 0; i < values; i++)
            ck_assert_msg(fabs((other[i] - gradient[i]) / (2 * d) - H[k][i]) <= 1e-6 * largest,
                          "%s: %d, %d: %.12g, by differences %.12g of %g", run.problem->name, k, i, H[k][i],
                          (other[i] - gradient[i]) / (2 * d), largest);
    }
    close_run(&run);
}
END_TEST

/* Momenta of velocities and back: dv is the derivative of v along (dq, dp, dc), dc recorded as the rates. */
START_TEST(velocities)
{
    static const double d = 1e-5;
    second_run run;
    tvi_system *tangent, *plain;
    double q[2 * COLUMNS_MOST_N], p[2 * COLUMNS_MOST_N], v[2 * COLUMNS_MOST_N], again[2 * COLUMNS_MOST_N];
    double v_near[2][COLUMNS_MOST_N], rates[COLUMNS_MOST_PARAMETERS], near[COLUMNS_MOST_PARAMETERS];
    open_run(&run, forms[_i]);
    const int n = run.n, of_p = run.is_lagrangian ? n : 0, of_dp = n - of_p;
    for (int i = 0; i < run.parameters; i++) rates[i] = 0.3 + 0.1 * i;
    for (int i = 0; i < n; i++) {
        q[i] = run.q[i], q[n + i] = cos(1 + i);
        p[of_p + i] = run.p[i] + 0.1, p[of_dp + i] = sin(2 + i);
    }
    ck_assert_int_eq(tvi_system_tangent(&tangent, run.system, rates), TVI_OK);
    ck_assert_int_eq(tvi_velocity(tangent, 0.2, q, p, v), TVI_OK);
    ck_assert_int_eq(tvi_momentum(tangent, 0.2, q, v, again), TVI_OK);
    for (int i = 0; i < 2 * n; i++) ck_assert_double_eq_tol(again[i], p[i], 1e-12);
    for (int side = 0; side < 2; side++) {
        const double by = side ? d : -d;
        double q_near[COLUMNS_MOST_N], p_near[COLUMNS_MOST_N];
        for (int i = 0; i < n; i++) q_near[i] = q[i] + by * q[n + i], p_near[i] = p[of_p + i] + by * p[of_dp + i];
        for (int i = 0; i < run.parameters; i++) near[i] = run.c[i] + by * rates[i];
        ck_assert_int_eq(tvi_apply_legendre_transform(run.system, near, 0.2, q_near, p_near, v_near[side], false),
                         TVI_OK);
    }
    ck_assert_int_eq(tvi_velocity(run.system, 0.2, q, p + of_p, again), TVI_OK);
    for (int i = 0; i < n; i++) {
        ck_assert_double_eq_tol(v[i], again[i], 1e-14);
        ck_assert_double_eq_tol(v[n + i], (v_near[1][i] - v_near[0][i]) / (2 * d), 1e-8);
    }
    ck_assert_int_eq(tvi_system_tangent(&plain, tangent, NULL), TVI_OK); /* third derivatives */
    tvi_system_free(plain);
    tvi_system_free(tangent);
    close_run(&run);
}
END_TEST

static jet any_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_add(1, jet_sqr(q[0]));
}

static void any_drive(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)v, (void)t;
    for (int i = 0; i < *(const int *)ctx; i++) force[i] = q[i];
}

static void any_constraint(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = q[0];
}

/* Of a tangent system no other one is made, and the texts say so. */
START_TEST(refusals_of_tangent_systems)
{
    second_run run;
    open_run(&run, forms[_i]);
    int N = 2 * run.n;
    double energy, q[2 * COLUMNS_MOST_N] = {0.1}, p[2 * COLUMNS_MOST_N] = {0}, rates[COLUMNS_MOST_PARAMETERS] = {NAN};
    tvi_system *out = run.tangent;
    tvi_options options;
    refused("a tangent system is not rescaled", tvi_system_rescaled(&out, run.tangent, any_scale, NULL),
            TVI_EUNSUPPORTED);
    refused("a tangent system is not rescaled", tvi_system_rescaled_reversible(&out, run.tangent, any_scale, NULL),
            TVI_EUNSUPPORTED);
    refused("a tangent system is not driven", tvi_system_driven(&out, run.tangent, any_drive, &N), TVI_EUNSUPPORTED);
    refused("a tangent system is not constrained", tvi_system_constrained(&out, run.tangent, 1, any_constraint, NULL),
            TVI_EUNSUPPORTED);
    ck_assert_ptr_null(out);
    refused("a tangent system has no energy", tvi_energy(run.tangent, 0, q, p, &energy), TVI_EUNSUPPORTED);
    if (run.parameters > 0) refused("rates[0] = nan", tvi_system_tangent(&out, run.system, rates), TVI_EINVAL);
    ck_assert_int_eq(tvi_options_named("midpoint", 8, &options), TVI_OK);
    const tvi_status of_system = tvi_options_check(run.system, &options, NULL);
    if (of_system != TVI_OK) ck_assert_int_eq(tvi_options_check(run.tangent, &options, NULL), of_system);
    if (run.tangent->form == TVI_FIELD)
        refused(run.system->is_driven ? "driven" : "the tangent system of a Hamiltonian",
                tvi_integrator_create(&(tvi_integrator *){NULL}, run.tangent, &options), TVI_EUNSUPPORTED);
    close_run(&run);
}
END_TEST

START_TEST(refusals)
{
    columns_run run;
    tvi_system *tangent;
    refused("out is NULL", tvi_system_tangent(NULL, NULL, NULL), TVI_EINVAL);
    refused("system is NULL", tvi_system_tangent(&tangent, NULL, NULL), TVI_EINVAL);
    columns_open(&run, gradient_problem(_i ? GRADIENT_K : COLUMNS_REVERSIBLE), "galerkin", 16);
    tangent = run.system;
    refused("a rescaled system has no tangent system", tvi_system_tangent(&tangent, run.system, NULL),
            TVI_EUNSUPPORTED);
    ck_assert_ptr_null(tangent);
    columns_close(&run);
}
END_TEST

TCase *tcase_second(void)
{
    TCase *tcase = tcase_create("second");
    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, symmetric_and_as_by_differences, 0, sizeof forms / sizeof *forms);
    tcase_add_loop_test(tcase, velocities, 0, sizeof forms / sizeof *forms);
    tcase_add_loop_test(tcase, refusals_of_tangent_systems, 0, sizeof forms / sizeof *forms);
    tcase_add_loop_test(tcase, refusals, 0, 2);
    return tcase;
}
