/* tangent_steps.c - Tests that a step with tangent vectors is the step, and one that fails leaves all as it was. */
#include "tangent.h"
#include "problems/refusals.h"

#include <math.h>
#include <string.h>

/* Bit for bit what tvi_step makes, step after step, the low-order parts, dense output and counts too. */
START_TEST(step_is_the_step)
{
    const kind *k = &kinds[_i % all_kinds];
    const model *m = models[_i / all_kinds];
    if (!kind_serves(k, m)) return;
    const tvi_options options = kind_options(k, 4);
    runs plain = open_runs(m, &options), with = open_runs(m, &options);
    test_state x = model_place(m), y = x;
    double D[MOST] = {1};
    for (int step = 0; step < 10; step++) {
        test_state dense_x = x, dense_y = y;
        go(plain.integrator, m->h, 1, &x);
        tangent_step(&with, m->h, &y, D, 1);
        ck_assert_msg(same_bits(m->n, &x, &y), "%s, %s: step %d", m->name, describe(&options), step);
        ck_assert_int_eq(tvi_dense(plain.integrator, 0.3, dense_x.q, dense_x.p), TVI_OK);
        ck_assert_int_eq(tvi_dense(with.integrator, 0.3, dense_y.q, dense_y.p), TVI_OK);
        ck_assert(same_bits(m->n, &dense_x, &dense_y));
    }
    tvi_stats a = *tvi_integrator_stats(plain.integrator), b = *tvi_integrator_stats(with.integrator);
    ck_assert_uint_gt(b.bytes, a.bytes);
    a.bytes = b.bytes = 0;
    ck_assert_mem_eq(&a, &b, sizeof a);
    close_runs(&plain);
    close_runs(&with);
}
END_TEST

/* More columns take more memory, each of them two columns of D. */
START_TEST(bytes_are_those_of_the_columns)
{
    const kind *k = &kinds[0];
    const model *m = models[0];
    const tvi_options options = kind_options(k, 4);
    runs r = open_runs(m, &options);
    test_state x = model_place(m);
    double D[2 * MOST * 4] = {0};
    tangent_step(&r, m->h, &x, D, 1);
    const size_t of_one = tvi_integrator_stats(r.integrator)->bytes;
    tangent_step(&r, m->h, &x, D, 4);
    ck_assert_uint_ge(tvi_integrator_stats(r.integrator)->bytes, of_one + 2 * 3 * (2 * (size_t)m->n) * sizeof *D);
    close_runs(&r);
}
END_TEST

/* On failure t, q, p and D are what they were, and the run goes on as if nothing had been asked. */
static void check_failure(const runs *r, double h, const test_state *at, double D[], int columns, tvi_status expected,
                          const char *culprit)
{
    test_state x = *at;
    double before[MOST * 2];
    const size_t bytes = columns > 0 ? 2 * (size_t)r->m->n * (size_t)columns * sizeof *D : 0;
    if (D) memcpy(before, D, bytes);
    refused(culprit, tvi_step_tangent(r->integrator, h, &x.t, x.q, x.p, D, columns), expected);
    ck_assert(same_bits(r->m->n, &x, at));
    if (D) ck_assert_mem_eq(before, D, bytes);
    double q[N_MAX], p[N_MAX];
    ck_assert_int_eq(tvi_dense(r->integrator, 0.5, q, p), TVI_EINVAL);
}

START_TEST(failures_leave_all_as_it_was)
{
    const model *m = &model_kepler;
    const tvi_options options = kind_options(&kinds[_i], 4);
    runs r = open_runs(m, &options), undisturbed = open_runs(m, &options);
    test_state x = model_start(m), y = x;
    double D[] = {1, 2, 0, 1, 0, 3, 1, -1}, huge[] = {1e308, 1, -1e308, 1, 1e308, 1, 1e308, 1};
    double nan[] = {1, 2, 0, 1, 0, NAN, 1, -1}, infinite[] = {1, 2, 0, 1, 0, 3, 1, INFINITY};
    go(r.integrator, m->h, 3, &x);
    go(undisturbed.integrator, m->h, 3, &y);
    const test_state at = x;
    check_failure(&r, m->h, &at, NULL, 2, TVI_EINVAL, "D is NULL");
    check_failure(&r, m->h, &at, D, 0, TVI_EINVAL, "columns is not positive");
    check_failure(&r, m->h, &at, D, -1, TVI_EINVAL, "columns is not positive");
    check_failure(&r, 0, &at, D, 2, TVI_EINVAL, "h is 0");
    check_failure(&r, NAN, &at, D, 2, TVI_EINVAL, "h = nan is not finite");
    check_failure(&r, m->h, &at, nan, 2, TVI_ENONFINITE, "row 2 of D is not finite");
    check_failure(&r, m->h, &at, infinite, 2, TVI_ENONFINITE, "row 3 of D is not finite");
    ck_assert_int_eq(tvi_step_tangent(r.integrator, 1e300, &x.t, x.q, x.p, D, 2) == TVI_OK, false);
    refused("t is NULL", tvi_step_tangent(r.integrator, m->h, NULL, x.q, x.p, D, 2), TVI_EINVAL);
    refused("q is NULL", tvi_step_tangent(r.integrator, m->h, &x.t, NULL, x.p, D, 2), TVI_EINVAL);
    refused("p is NULL", tvi_step_tangent(r.integrator, m->h, &x.t, x.q, NULL, D, 2), TVI_EINVAL);
    refused("integrator is NULL", tvi_step_tangent(NULL, m->h, &x.t, x.q, x.p, D, 2), TVI_EINVAL);
    x.q[0] = NAN;
    refused("q[0] = nan", tvi_step_tangent(r.integrator, m->h, &x.t, x.q, x.p, D, 2), TVI_ENONFINITE);
    x = at;
    check_failure(&r, 0.5, &at, huge, 2, TVI_ENONFINITE, "column 0 of D: it overflows");
    for (int step = 0; step < 3; step++) {
        tangent_step(&r, m->h, &x, D, 2);
        go(undisturbed.integrator, m->h, 1, &y);
    }
    ck_assert(same_bits(m->n, &x, &y));
    close_runs(&r);
    close_runs(&undisturbed);
}
END_TEST

TCase *tcase_tangent_steps(void)
{
    TCase *tcase = tcase_create("steps");
    tcase_add_loop_test(tcase, step_is_the_step, 0, MODELS * all_kinds);
    tcase_add_test(tcase, bytes_are_those_of_the_columns);
    tcase_add_loop_test(tcase, failures_leave_all_as_it_was, 0, all_kinds);
    return tcase;
}
