/* test_progress.c - Tests the bar: on a terminal, and nowhere else. */
#define _XOPEN_SOURCE 600 /* pseudo-terminals */
#include "events.h"
#include "runs.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int count_steps(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)t, (void)q, (void)p;
    ++*(long *)ctx;
    return step == 350;
}

/* Returns the text that a run of 400 steps with the bar writes to the standard error, which is the descriptor `end`
 * meanwhile. */
static void draw(int end, tvi_observer *observer, void *ctx, tvi_status wanted)
{
    run r = run_open(&scene_pendulum, "midpoint", 4);
    tvi_progress_bar bar = {.steps = 400, .observer = observer, .ctx = ctx};
    const int kept = dup(STDERR_FILENO);
    ck_assert_int_ge(kept, 0);
    ck_assert_int_ge(dup2(end, STDERR_FILENO), 0);
    const tvi_status status = tvi_integrate(r.integrator, 0.1, 400, &r.x.t, r.x.q, r.x.p, tvi_progress, &bar);
    ck_assert_int_ge(dup2(kept, STDERR_FILENO), 0);
    close(kept);
    ck_assert_int_eq(status, wanted);
    run_close(&r);
}

static size_t read_all(int end, char text[], size_t size)
{
    size_t length = 0;
    fcntl(end, F_SETFL, O_NONBLOCK);
    for (ssize_t got; length + 1 < size && (got = read(end, text + length, size - 1 - length)) > 0;)
        length += (size_t)got;
    text[length] = 0;
    return length;
}

START_TEST(bar_on_a_terminal)
{
    char text[32768];
    const int master = posix_openpt(O_RDWR | O_NOCTTY);
    ck_assert_int_ge(master, 0);
    ck_assert_int_eq(grantpt(master) | unlockpt(master), 0);
    const int slave = open(ptsname(master), O_RDWR | O_NOCTTY);
    ck_assert_int_ge(slave, 0);
    ck_assert_int_eq(isatty(slave), 1);
    long steps = 0;
    tvi_progress_bar bar = {.steps = 100, .observer = count_steps, .ctx = &steps};
    const int kept = dup(STDERR_FILENO);
    ck_assert_int_ge(dup2(slave, STDERR_FILENO), 0);
    size_t length = 0;
    for (long step = 1; step <= 100; step++) {
        ck_assert_int_eq(tvi_progress(step, 0.5, NULL, NULL, &bar), 0);
        length += read_all(master, text + length, sizeof text - length);
    }
    ck_assert_int_ge(dup2(kept, STDERR_FILENO), 0);
    close(kept);
    ck_assert_int_eq(steps, 100);
    ck_assert_ptr_nonnull(strstr(text, "]   1 %"));
    ck_assert_ptr_nonnull(strstr(text, "\r[#########################                         ]  50 %  t = 0.5"));
    ck_assert_ptr_nonnull(strstr(text, "\r[##################################################] 100 %"));
    ck_assert_int_eq(text[length - 1], '\n');
    close(slave);
    close(master);
}
END_TEST

START_TEST(nothing_elsewhere)
{
    char text[4096];
    int ends[2];
    ck_assert_int_eq(pipe(ends), 0);
    long steps = 0;
    draw(ends[1], NULL, NULL, TVI_OK);
    draw(ends[1], count_steps, &steps, TVI_ESTOPPED);
    ck_assert_int_eq(steps, 350);
    ck_assert_uint_eq(read_all(ends[0], text, sizeof text), 0);
    ck_assert_int_eq(tvi_progress(1, 0, NULL, NULL, NULL), 0);
    close(ends[0]);
    close(ends[1]);
}
END_TEST

Suite *suite_progress(void)
{
    Suite *suite = suite_create("progress");
    TCase *tcase = tcase_create("progress");
    tcase_add_test(tcase, bar_on_a_terminal);
    tcase_add_test(tcase, nothing_elsewhere);
    suite_add_tcase(suite, tcase);
    return suite;
}
