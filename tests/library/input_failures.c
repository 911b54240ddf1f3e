/* input_failures.c - Tests that a step that fails leaves no trace in what follows, and that TVI_OR_EXIT says why and
 * ends a program. */
#include "input.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { BEFORE_MOST = 20, AFTER = 20, LONG_RUN = BEFORE_MOST + AFTER };

/* Step number `step` of a run: at first of one size, then of changing size, back and forth. */
static tvi_status next_step(tvi_integrator *integrator, int step, state *s)
{
    return step_once(integrator, (step % 24 < 16 ? good_step : -good_step) / (step < 8 ? 1 : 1 + step % 3), s);
}

/* The states of a run without failures, from the start on; with `resets` each step is as the first. */
static void plain_run(const pair *x, bool resets, state s[LONG_RUN + 1])
{
    tvi_integrator *integrator = create_integrator(x->system, x->m);
    s[0] = start_of(x->problem);
    for (int step = 0; step < LONG_RUN; step++) {
        s[step + 1] = s[step];
        if (resets) tvi_integrator_reset(integrator);
        expect(x->name, next_step(integrator, step, &s[step + 1]), TVI_OK);
    }
    tvi_integrator_free(integrator);
}

/* A run that tries h, and a state that is NaN, after some steps; the status of h. If h fails, the steps that follow are
 * bit for bit those of the plain run. */
static tvi_status failing_run(const pair *x, int before, double h, const state plain[LONG_RUN + 1])
{
    tvi_integrator *integrator = create_integrator(x->system, x->m);
    state s = plain[0], bad;
    for (int step = 0; step < before; step++) expect(x->name, next_step(integrator, step, &s), TVI_OK);
    bad = s;
    bad.p[0] = NAN;
    ck_assert_int_eq(tvi_step(integrator, h, &bad.t, bad.q, bad.p), isfinite(h) ? TVI_ENONFINITE : TVI_EINVAL);
    const tvi_status status = step_once(integrator, h, &s);
    for (int step = before; status != TVI_OK && step < before + AFTER; step++) {
        expect(x->name, next_step(integrator, step, &s), TVI_OK);
        expect_same(x->name, &s, &plain[step + 1]);
    }
    if (status != TVI_OK) ck_assert_int_eq(tvi_integrator_stats(integrator)->steps, before + AFTER);
    tvi_integrator_free(integrator);
    return status;
}

/* Control: forgetting the low-order parts does change what follows. */
START_TEST(failures_leave_no_trace)
{
    static const int before[] = {0, 1, 5, 17, BEFORE_MOST};
    static const double h[] = {0.7, -2.5, 30, -1e3, 1e6, 1e120, DBL_MAX, NAN};
    pair x;
    if (!open_pair(&x, _i)) return;
    state plain[LONG_RUN + 1], resetting[LONG_RUN + 1];
    long count[TVI_STATUS_COUNT] = {0};
    plain_run(&x, false, plain);
    plain_run(&x, true, resetting);
    ck_assert_msg(memcmp(resetting, plain, sizeof plain) != 0, "%s: the control", x.name);
    for (size_t i = 0; i < sizeof before / sizeof *before; i++)
        for (size_t j = 0; j < sizeof h / sizeof *h; j++) count[failing_run(&x, before[i], h[j], plain)]++;
    const long tries = sizeof before / sizeof *before;
    const long failed =
        count[TVI_ENOCONV] + count[TVI_EDOMAIN] + count[TVI_ESINGULAR] + count[TVI_ENONFINITE] + count[TVI_ETOOLARGE];
    ck_assert_int_eq(count[TVI_EINVAL], tries);
    /* DBL_MAX at least; far from the centre of Kepler a step of low order may be as large */
    ck_assert_int_ge(failed, x.problem == &scene_kepler && x.m->order <= 2 ? 0 : tries);
    close_pair(&x);
}
END_TEST

/* In a process of its own, whose stderr is read here. */
START_TEST(or_exit)
{
    char said[200] = "";
    int ends[2], status;
    tvi_system *system;
    ck_assert_int_eq(pipe(ends), 0);
    const int child = fork();
    if (child == 0) {
        dup2(ends[1], STDERR_FILENO);
        TVI_OR_EXIT(TVI_OK);
        TVI_OR_EXIT(TVI_ESTOPPED);
        fprintf(stderr, "went on, ");
        TVI_OR_EXIT(tvi_system_potential(&system, -7, NULL, NULL, NULL));
        fprintf(stderr, "to here");
        _exit(0);
    }
    (void)close(ends[1]);
    for (size_t size = 0; size < sizeof said - 1;) {
        const ssize_t count = read(ends[0], said + size, sizeof said - 1 - size);
        if (count <= 0) break;
        size += (size_t)count;
    }
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    ck_assert(WIFEXITED(status) && WEXITSTATUS(status) == EXIT_FAILURE);
    ck_assert_ptr_nonnull(strstr(said, "went on, " __FILE__));
    ck_assert_ptr_nonnull(strstr(said, ": invalid argument: n = -7 is not"));
    (void)close(ends[0]);
}
END_TEST

TCase *tcase_failed_steps(void)
{
    TCase *tcase = tcase_create("after a failure");
    tcase_add_test(tcase, or_exit);
    tcase_add_loop_test(tcase, failures_leave_no_trace, 0, problem_count * method_count);
    return tcase;
}
