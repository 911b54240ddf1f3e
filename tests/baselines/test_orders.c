/* test_orders.c - Tests each baseline's order of convergence, in q and in p. */
#include "baselines.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- The slope of the error -------------------------------------------------------------------------------------- */

/* Runs of ever more steps until the error of q or p would be less than 50 times roundoff: the slopes between the last
 * and the last but three, where the method is furthest into its asymptotic range. An error is the larger of two times,
 * so that none is small by chance. */
enum { TIMES = 2, STEPS_FIRST = 4, STEPS_MOST = 2000, BACK = 3 };
static const double STEP_RATIO = 1.2, ROUNDOFFS = 50;

typedef struct {
    const test_problem *problem;
    exact_state at[TIMES];
    two_errors roundoff;
} reference;

static reference reference_of(const test_problem *problem)
{
    reference exact = {.problem = problem, .roundoff = problem_roundoff(problem)};
    for (int k = 0; k < TIMES; k++) exact.at[k] = problem_exact(problem, NULL, problem->t_end * (k + 1) / TIMES);
    return exact;
}

/* The errors of runs of step t_end / (TIMES steps). false: the step is too large. */
static bool run_if_possible(const reference *exact, const baseline *b, long steps, two_errors *errors)
{
    const test_problem *problem = exact->problem;
    const double h = problem->t_end / (double)(TIMES * steps);
    *errors = (two_errors){0, 0};
    for (int k = 0; k < TIMES; k++) {
        test_state x;
        if (baseline_run(b, problem, h, steps * (k + 1), &x) != TVI_OK) return false;
        const two_errors now = state_error(problem->scene->n, &x, &exact->at[k]);
        *errors = (two_errors){fmax(errors->q, now.q), fmax(errors->p, now.p)};
    }
    return true;
}

typedef struct {
    long steps;
    two_errors error;
} result;

/* 0 with fewer than BACK + 1 runs. */
static two_errors slope_of(const reference *exact, const baseline *b, result last[BACK + 1])
{
    int runs = 0;
    for (double count = STEPS_FIRST; count < STEPS_MOST; count *= STEP_RATIO) {
        result now = {.steps = lround(count / TIMES)};
        if (runs > 0 && now.steps == last[0].steps) continue;
        if (!run_if_possible(exact, b, now.steps, &now.error)) continue;
        if (now.error.q < ROUNDOFFS * exact->roundoff.q || now.error.p < ROUNDOFFS * exact->roundoff.p) break;
        memmove(last + 1, last, BACK * sizeof *last);
        last[0] = now;
        runs++;
    }
    if (runs <= BACK) return (two_errors){0, 0};
    const double ratio = log((double)last[0].steps / (double)last[BACK].steps);
    return (two_errors){log(last[BACK].error.q / last[0].error.q) / ratio,
                        log(last[BACK].error.p / last[0].error.p) / ratio};
}

static void check_order(const baseline *b, const test_problem *problem)
{
    const reference exact = reference_of(problem);
    result last[BACK + 1] = {{0}};
    const two_errors slope = slope_of(&exact, b, last);
    ck_assert_msg(fabs(slope.q - b->order) < 0.45 && fabs(slope.p - b->order) < 0.45,
                  "%s %d, %s: order %.2f in q and %.2f in p (errors %.1e, %.1e after %ld steps)", b->name, b->order,
                  problem->scene->name, slope.q, slope.p, last[0].error.q, last[0].error.p, last[0].steps);
}

/* Problems in which double precision has room for the asymptotic range: for the highest orders only in the chain of two
 * time scales, for those of Runge and Kutta and of Taylor in two problems. The Taylor method above 10 has a test of its
 * own. */
enum { PENDULUM = 1, KEPLER = 2, HENON_HEILES = 4, FPU = 8, SOLAR = 16, ALL = 31 };

static int problems_of(const baseline *b)
{
    if (strcmp(b->name, "gauss") == 0) return b->order <= 10 ? ALL : FPU;
    if (strcmp(b->name, "taylor-by-hand") == 0) return b->order <= 8 ? KEPLER | SOLAR : b->order == 10 ? KEPLER : 0;
    if (strcmp(b->name, "gsl-rk8pd") == 0) return KEPLER | HENON_HEILES;
    if (strcmp(b->name, "arkode-erkstep") == 0) return KEPLER | SOLAR;
    return ALL;
}

START_TEST(baseline_has_its_order)
{
    const baseline *b = baseline_at(_i / BASELINE_PROBLEMS);
    const int problem = _i % BASELINE_PROBLEMS;
    if (!b->adaptive && (problems_of(b) & 1 << problem)) check_order(b, baseline_problems[problem]);
}
END_TEST

/* ---- The Taylor method, all orders ------------------------------------------------------------------------------- */

/* On Kepler's circle, q = (cos t, sin t), one step is the Taylor polynomial of degree N, with its large remainder. */
START_TEST(taylor_is_its_polynomial)
{
    const baseline *b = baseline_at(_i);
    if (strcmp(b->name, "taylor-by-hand") != 0) return;
    const double h = b->order / 3.0;
    const baseline_task task = {.scene = &scene_kepler, .h = h, .steps = 1};
    double q[2] = {1, 0}, p[2] = {0, 1};
    baseline_counts counts;
    ck_assert_int_eq(b->run(b, &task, q, p, &counts), TVI_OK);
    long double cosine = 0, sine = 0, term = 1;
    for (int k = 0; k <= b->order; k++, term *= h / (long double)k) {
        if (k % 2 == 0) cosine += k % 4 == 0 ? term : -term;
        if (k % 2 == 1) sine += k % 4 == 1 ? term : -term;
    }
    ck_assert_ldouble_gt(fabsl(cosine - cosl(h)) + fabsl(sine - sinl(h)), 1e-6);
    const double size = 1e-14 * exp(2 * h); /* q and w times the series' largest terms */
    ck_assert_double_eq_tol(q[0], (double)cosine, size);
    ck_assert_double_eq_tol(q[1], (double)sine, size);
    ck_assert_double_eq_tol(p[0], -(double)sine, size);
    ck_assert_double_eq_tol(p[1], (double)cosine, size);
}
END_TEST

/* ---- The double pendulum ----------------------------------------------------------------------------------------- */

/* The largest error at the scene's end, against its reference. */
static double double_pendulum_error(long steps)
{
    const scene *s = &scene_double_pendulum;
    const baseline_task task = {.scene = s, .h = s->t_end / (double)steps, .steps = steps};
    double q[2] = {s->q[0], s->q[1]}, p[2] = {s->p[0], s->p[1]}, error = 0;
    baseline_counts counts;
    ck_assert_int_eq(baseline_double_pendulum.run(&baseline_double_pendulum, &task, q, p, &counts), TVI_OK);
    for (int i = 0; i < 2; i++)
        error = fmax(error, fmax(fabs(q[i] - s->reference[i]), fabs(p[i] - s->reference[2 + i])));
    return error;
}

/* Slopes wander: the error changes sign. From 20 to 80 steps it falls as the power 11.2 of the step. */
START_TEST(double_pendulum_has_its_order)
{
    const double order = log(double_pendulum_error(20) / double_pendulum_error(80)) / log(4);
    ck_assert_double_eq_tol(order, 11.2, 0.3);
    ck_assert_double_lt(double_pendulum_error(120), 1e-14);
}
END_TEST

/* ---- Those that choose their steps ------------------------------------------------------------------------------- */

static double error_at(const baseline *b, double tolerance)
{
    const scene *s = &scene_kepler;
    const baseline_task task = {.scene = s, .h = s->t_end, .steps = 1, .tolerance = tolerance};
    double q[2] = {s->q[0], s->q[1]}, p[2] = {s->p[0], s->p[1]}, error = 0;
    baseline_counts counts;
    ck_assert_int_eq(b->run(b, &task, q, p, &counts), TVI_OK);
    ck_assert_int_gt(counts.steps, 100);
    for (int i = 0; i < 2; i++)
        error = fmax(error, fmax(fabs(q[i] - s->reference[i]), fabs(p[i] - s->reference[2 + i])));
    return error;
}

/* A tolerance that falls a thousandfold takes the error with it, to a power from 2/3 to 4/3. */
START_TEST(error_follows_the_tolerance)
{
    const baseline *b = baseline_at(_i);
    if (!b->adaptive) return;
    const double coarse = error_at(b, 1e-8), fine = error_at(b, 1e-11);
    ck_assert_msg(coarse / fine > 1e2 && coarse / fine < 1e4 && fine < 1e-5, "%s: errors %.1e, %.1e", b->name, coarse,
                  fine);
}
END_TEST

Suite *suite_orders(void)
{
    Suite *suite = suite_create("orders");
    TCase *tcase = tcase_create("orders");
    int count = 0;
    while (baseline_at(count)) count++;
    tcase_add_loop_test(tcase, baseline_has_its_order, 0, count * BASELINE_PROBLEMS);
    tcase_add_loop_test(tcase, taylor_is_its_polynomial, 0, count);
    tcase_add_test(tcase, double_pendulum_has_its_order);
    tcase_add_loop_test(tcase, error_follows_the_tolerance, 0, count);
    suite_add_tcase(suite, tcase);
    return suite;
}
