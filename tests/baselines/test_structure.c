/* test_structure.c - Tests what the baselines keep: the symplectic form, reversibility, angular momentum; and what they
 * say when they fail. Runge-Kutta and Taylor are the controls that must not keep it. */
#include "baselines.h"

#include <math.h>
#include <string.h>

static bool is_one_of(const baseline *b, const char *const names[])
{
    for (; *names; names++)
        if (strcmp(b->name, *names) == 0) return true;
    return false;
}

static const char *const symplectic[] = {"verlet", "blanes-moan", "kahan-li", "shooting", "gauss", NULL};
static const char *const symmetric[] = {"verlet", "blanes-moan", "kahan-li", "gauss", NULL};

/* The controls whose defects show: of low order. */
static bool is_control(const baseline *b)
{
    return (strcmp(b->name, "taylor-by-hand") == 0 && b->order <= 8) || strcmp(b->name, "gsl-rk8pd") == 0 ||
           strcmp(b->name, "arkode-erkstep") == 0;
}

static tvi_status run_from(const baseline *b, const scene *s, double h, long steps, double q[], double p[])
{
    const baseline_task task = {.scene = s, .h = h, .steps = steps};
    baseline_counts counts;
    return b->run(b, &task, q, p, &counts);
}

/* ---- M^T J M = J ------------------------------------------------------------------------------------------------- */

/* The largest entry of M^T J M - J of two steps from a point that no symmetry singles out, M by central differences. */
static double symplectic_defect(const baseline *b, const scene *s, double h)
{
    const int n = s->n;
    const double step = 1e-5;
    double M[2 * BASELINE_N_MAX][2 * BASELINE_N_MAX], largest = 0;
    for (int column = 0; column < 2 * n; column++) {
        double x[2][2 * BASELINE_N_MAX] = {{0}};
        for (int side = 0; side < 2; side++) {
            for (int i = 0; i < n; i++) {
                x[side][i] = s->q[i] + 0.01 * (i + 1);
                x[side][n + i] = s->p[i] - 0.02 * (i + 1);
            }
            x[side][column] += side ? step : -step;
            ck_assert_int_eq(run_from(b, s, h, 2, x[side], x[side] + n), TVI_OK);
        }
        for (int row = 0; row < 2 * n; row++) M[row][column] = (x[1][row] - x[0][row]) / (2 * step);
    }
    for (int i = 0; i < 2 * n; i++)
        for (int j = 0; j < 2 * n; j++) {
            double sum = 0;
            for (int k = 0; k < n; k++) sum += M[k][i] * M[n + k][j] - M[n + k][i] * M[k][j];
            largest = fmax(largest, fabs(sum - (j == i + n) + (i == j + n)));
        }
    return largest;
}

static const struct {
    const scene *scene;
    double h;
} large_steps[] = {{&scene_kepler, 0.5}, {&scene_henon_heiles_8, 0.78125}, {&scene_fpu, 0.03125}};
enum { LARGE_STEPS = sizeof large_steps / sizeof *large_steps };

START_TEST(steps_are_symplectic)
{
    const baseline *b = baseline_at(_i / LARGE_STEPS);
    const scene *s = large_steps[_i % LARGE_STEPS].scene;
    if (!baseline_serves(b, s) || !(is_one_of(b, symplectic) || is_control(b))) return;
    const double defect = symplectic_defect(b, s, large_steps[_i % LARGE_STEPS].h);
    if (is_one_of(b, symplectic))
        ck_assert_msg(defect < 2e-8, "%s %d, %s: defect %.1e", b->name, b->order, s->name, defect);
    else ck_assert_msg(defect > 1e-7, "%s %d, %s: defect only %.1e", b->name, b->order, s->name, defect);
}
END_TEST

/* ---- Back and forth ---------------------------------------------------------------------------------------------- */

START_TEST(symmetric_methods_go_back)
{
    const baseline *b = baseline_at(_i);
    const scene *s = &scene_kepler;
    double q[2] = {s->q[0], s->q[1]}, p[2] = {s->p[0] + 0.1, s->p[1]};
    if (b->adaptive || !(is_one_of(b, symmetric) || is_control(b) || strcmp(b->name, "shooting") == 0)) return;
    ck_assert_int_eq(run_from(b, s, 0.25, 10, q, p), TVI_OK);
    ck_assert_int_eq(run_from(b, s, -0.25, 10, q, p), TVI_OK);
    const double away =
        fmax(fmax(fabs(q[0] - s->q[0]), fabs(q[1] - s->q[1])), fmax(fabs(p[0] - s->p[0] - 0.1), fabs(p[1] - s->p[1])));
    if (is_one_of(b, symmetric)) ck_assert_msg(away < 1e-13, "%s %d: %.1e from the start", b->name, b->order, away);
    else ck_assert_msg(away > 1e-7, "%s %d: only %.1e from the start", b->name, b->order, away);
}
END_TEST

/* ---- Noether ----------------------------------------------------------------------------------------------------- */

static void angular_momentum(const double q[], const double p[], double L[3])
{
    L[0] = L[1] = L[2] = 0;
    for (int i = 0; i < 18; i += 3)
        for (int k = 0; k < 3; k++)
            L[k] += q[i + (k + 1) % 3] * p[i + (k + 2) % 3] - q[i + (k + 2) % 3] * p[i + (k + 1) % 3];
}

START_TEST(angular_momentum_is_kept)
{
    const baseline *b = baseline_at(_i);
    const scene *s = &scene_solar;
    double q[18], p[18], before[3], after[3], change = 0, size = 0;
    if (!(is_one_of(b, symplectic) || is_control(b))) return;
    memcpy(q, s->q, sizeof q);
    memcpy(p, s->p, sizeof p);
    angular_momentum(q, p, before);
    ck_assert_int_eq(run_from(b, s, 400, 50, q, p), TVI_OK);
    angular_momentum(q, p, after);
    for (int k = 0; k < 3; k++) {
        change = fmax(change, fabs(after[k] - before[k]));
        size = fmax(size, fabs(before[k]));
    }
    if (is_one_of(b, symplectic)) ck_assert_msg(change < 1e-13 * size, "%s %d: %.1e", b->name, b->order, change / size);
    else ck_assert_msg(change > 1e-10 * size, "%s %d: only %.1e", b->name, b->order, change / size);
}
END_TEST

/* ---- Observers and failures -------------------------------------------------------------------------------------- */

typedef struct {
    long calls, stop_after;
    double t, q[2], p[2];
} last_seen;

static int see(long step, double t, const double q[], const double p[], void *ctx)
{
    last_seen *seen = ctx;
    ck_assert_int_eq(step, ++seen->calls);
    seen->t = t;
    memcpy(seen->q, q, sizeof seen->q);
    memcpy(seen->p, p, sizeof seen->p);
    return step == seen->stop_after;
}

/* An observer sees each step and the same end; without one the end is the same to roundoff. */
START_TEST(observers_see_every_step)
{
    const baseline *b = baseline_at(_i);
    const scene *s = &scene_kepler;
    double q[2] = {s->q[0], s->q[1]}, p[2] = {s->p[0], s->p[1]}, r[2] = {s->q[0], s->q[1]}, u[2] = {s->p[0], s->p[1]};
    last_seen seen = {0};
    baseline_task task = {.scene = s, .h = 0.125, .steps = 20, .tolerance = 1e-9, .observer = see, .ctx = &seen};
    baseline_counts counts;
    ck_assert_int_eq(b->run(b, &task, q, p, &counts), TVI_OK);
    ck_assert_int_eq(seen.calls, counts.steps);
    ck_assert(b->adaptive || counts.steps == task.steps);
    ck_assert_double_eq_tol(seen.t, 2.5, 1e-14);
    task.observer = NULL;
    ck_assert_int_eq(b->run(b, &task, r, u, &counts), TVI_OK);
    for (int i = 0; i < 2; i++) {
        ck_assert_double_eq_tol(seen.q[i], q[i], 1e-15);
        ck_assert_double_eq_tol(seen.p[i], p[i], 1e-15);
        ck_assert_double_eq_tol(r[i], q[i], 1e-13);
        ck_assert_double_eq_tol(u[i], p[i], 1e-13);
    }
    seen = (last_seen){.stop_after = 3};
    task.observer = see;
    ck_assert_int_eq(b->run(b, &task, q, p, &counts), TVI_ESTOPPED);
    ck_assert_int_eq(seen.calls, 3);
}
END_TEST

START_TEST(too_large_steps_are_refused)
{
    const scene *s = &scene_kepler;
    double q[2] = {s->q[0], s->q[1]}, p[2] = {s->p[0], s->p[1]};
    ck_assert_int_eq(run_from(baseline_find("gauss", 4), s, 1.25, 100, q, p), TVI_ENOCONV);
    memcpy(q, s->q, sizeof q);
    memcpy(p, s->p, sizeof p);
    ck_assert_int_eq(run_from(baseline_find("shooting", 4), s, 1.25, 100, q, p), TVI_ENOCONV);
    memset(q, 0, sizeof q); /* the force has no value */
    for (const baseline *b = baselines_composition; b->name; b++)
        ck_assert_int_eq(run_from(b, s, 0.1, 10, q, p), TVI_ENONFINITE);
    ck_assert_int_eq(run_from(baseline_find("gauss", 16), s, 0.1, 10, q, p), TVI_ENOCONV);
}
END_TEST

Suite *suite_structure(void)
{
    Suite *suite = suite_create("structure");
    TCase *tcase = tcase_create("structure");
    int count = 0;
    while (baseline_at(count)) count++;
    tcase_add_loop_test(tcase, steps_are_symplectic, 0, count * LARGE_STEPS);
    tcase_add_loop_test(tcase, symmetric_methods_go_back, 0, count);
    tcase_add_loop_test(tcase, angular_momentum_is_kept, 0, count);
    tcase_add_loop_test(tcase, observers_see_every_step, 0, count);
    tcase_add_test(tcase, too_large_steps_are_refused);
    suite_add_tcase(suite, tcase);
    return suite;
}
