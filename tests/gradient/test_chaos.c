/* test_chaos.c - Tests the Lyapunov exponent and MEGNO of tvi_run_chaos: by their sums over steps of tvi_step_tangent,
 * on regular and chaotic orbits, and that the run beside them is the user's, bit for bit. */
#include "gradient.h"
#include "problems/refusals.h"
#include "system/system.h"

#include <math.h>
#include <string.h>

static void go(columns_run *run, const tvi_run_plan *plan, tvi_chaos *chaos)
{
    const tvi_status status = tvi_run_chaos(run->it, plan, chaos, &run->t, run->q, run->p);
    ck_assert_msg(status == TVI_OK, "%s: %s", run->problem->name, tvi_last_error());
}

static tvi_chaos chaos_of(columns_run *run, long steps)
{
    tvi_chaos chaos = {0};
    const tvi_run_plan plan = {.h = run->problem->h, .steps = steps};
    go(run, &plan, &chaos);
    ck_assert_int_eq(chaos.steps, steps);
    return chaos;
}

static void same_chaos(const tvi_chaos *a, const tvi_chaos *b)
{
    ck_assert(a->steps == b->steps && a->time == b->time && a->t_start == b->t_start && a->growth == b->growth);
    ck_assert(a->lyapunov == b->lyapunov && a->megno == b->megno && a->y == b->y);
}

/* The same sums, with a vector that is brought back to length 1 after each step. Of all systems here the forces alone
 * have masses other than 1. */
static tvi_chaos sum_up(columns_run *run, double h, long steps)
{
    double D[COLUMNS_MOST_ROWS] = {0}, mass[COLUMNS_MOST_N], length = 0, weighted = 0, area = 0, Y = 0;
    bool is_at_rest = true;
    tvi_chaos chaos = {0};
    for (int i = 0; i < run->n; i++) mass[i] = run->system->form == TVI_SEPARABLE ? run->system->mass[i] : 1;
    for (int i = 0; i < run->n; i++) is_at_rest = is_at_rest && run->p[i] == 0;
    for (int i = 0; i < run->n; i++) {
        const double component = 2 * fmod((i + 1) * (sqrt(5) - 1) / 2, 1) - 1;
        D[is_at_rest ? i : run->n + i] = component * (is_at_rest ? 1 : mass[i]);
        length = hypot(length, component);
    }
    for (long step = 0; step < steps; step++) {
        const double before = run->t, length_before = length;
        for (int i = 0; i < 2 * run->n; i++) D[i] /= length_before;
        ck_assert_int_eq(tvi_step_tangent(run->it, h, &run->t, run->q, run->p, D, 1), TVI_OK);
        length = 0;
        for (int i = 0; i < run->n; i++) length = hypot(length, hypot(D[i], D[run->n + i] / mass[i]));
        chaos.growth += log(length);
        weighted += log(length) * (before + run->t) / 2;
        area += (Y + 2 * weighted / run->t) / 2 * (run->t - before);
        Y = 2 * weighted / run->t;
    }
    chaos.y = Y, chaos.megno = area / run->t, chaos.lyapunov = chaos.growth / run->t;
    return chaos;
}

static void expect_near(const char *what, double is, double wanted)
{
    ck_assert_msg(fabs(is - wanted) <= 1e-9 * fmax(1, fabs(wanted)), "%s: %.17g, not %.17g", what, is, wanted);
}

static void expect_sums(const char *name, const tvi_chaos *is, const tvi_chaos *wanted)
{
    expect_near(name, is->growth, wanted->growth);
    expect_near(name, is->lyapunov, wanted->lyapunov);
    expect_near(name, is->y, wanted->y);
    expect_near(name, is->megno, wanted->megno);
}

/* Of all systems, and of a method whose columns are moved alone. The chaotic vector is scaled twice or more. */
START_TEST(sums)
{
    const bool is_other = _i == GRADIENT_PROBLEMS;
    const columns_problem *problem = is_other ? &columns_problems[COLUMNS_KEPLER] : gradient_problem(_i);
    const long steps = _i == COLUMNS_CHAOTIC ? 10000 : is_other ? 200 : 1000;
    columns_run pair[2];
    columns_open_pair(pair, problem, is_other ? "midpoint" : NULL, 8);
    const tvi_chaos chaos = chaos_of(&pair[0], steps), wanted = sum_up(&pair[1], problem->h, steps);
    columns_same_state(pair);
    expect_sums(problem->name, &chaos, &wanted);
    columns_close_pair(pair);
}
END_TEST

/* 2 on regular orbits. On a chaotic one Y is twice the mean of MEGNO, which grows as lambda t / 2. */
START_TEST(order_and_chaos)
{
    static const int regular[] = {COLUMNS_KEPLER, COLUMNS_BODIES, COLUMNS_REVERSIBLE};
    columns_run run;
    columns_open(&run, &columns_problems[_i < 3 ? regular[_i] : COLUMNS_CHAOTIC], NULL, 0);
    const tvi_chaos chaos = chaos_of(&run, 10000);
    const double wanted = _i < 3 ? 2 : chaos.lyapunov * run.t / 2;
    if (_i < 3) ck_assert_msg(fabs(chaos.megno - 2) < 0.05, "%s: %g", run.problem->name, chaos.megno);
    else ck_assert_msg(chaos.megno > wanted / 2 && chaos.megno < 2 * wanted, "%g, %g", chaos.megno, wanted);
    columns_close(&run);
}
END_TEST

/* ---- The run of the user ----------------------------------------------------------------------------------------- */

static jet first(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t;
    return jet_sub(q[0], *(const double *)ctx);
}

/* What observers were told, and how many steps the sums had then. */
typedef struct {
    int count;
    const tvi_chaos *chaos;
    double told[4000][2];
} diary;

static int tell(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    diary *d = ctx;
    (void)p;
    ck_assert(member == 0 && d->count < 4000);
    d->told[d->count][0] = t + which;
    d->told[d->count++][1] = q[0];
    return 0;
}

static int tell_step(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    const diary *d = ctx;
    if (d->chaos) ck_assert(d->chaos->steps == which && fabs(d->chaos->time - t) <= 1e-15 * t);
    return tell(member, which, t, q, p, ctx);
}

static int tell_members(long step, int members, const double t[], const double q[], const double p[],
                        const tvi_status status[], void *ctx)
{
    ck_assert(members == 1 && status[0] == TVI_OK);
    return tell(0, (int)step, *t, q, p, ctx);
}

START_TEST(same_run)
{
    static diary with, without;
    const double times[] = {1.3, 1.4, 6.05, 12}, level = 0.1;
    tvi_event *event;
    columns_run pair[2];
    columns_open_pair(pair, &columns_problems[_i], NULL, 0);
    ck_assert_int_eq(tvi_event_create(&event, pair[0].n, TVI_EITHER, false, first, (void *)&level), TVI_OK);
    const tvi_event *const events[] = {event};
    tvi_chaos chaos = {0};
    with = (diary){.chaos = &chaos}, without = (diary){0};
    tvi_run_plan plan = {.h = pair[0].problem->h,
                         .t_end = 13,
                         .has_t_end = true,
                         .times = times,
                         .time_count = 4,
                         .at_time = tell,
                         .events = events,
                         .event_count = 1,
                         .on_event = tell,
                         .at_step = tell_step,
                         .ctx = &with};
    go(&pair[0], &plan, &chaos);
    ck_assert(chaos.time == 13 && pair[0].t == 13);
    plan.ctx = &without;
    ck_assert_int_eq(tvi_run(pair[1].it, &plan, &pair[1].t, pair[1].q, pair[1].p), TVI_OK);
    plan = (tvi_run_plan){.h = pair[0].problem->h, .steps = 20, .observer = tell_members, .ctx = &with};
    go(&pair[0], &plan, &chaos);
    ck_assert_int_eq(chaos.steps, 20);
    plan.ctx = &without;
    ck_assert_int_eq(tvi_run(pair[1].it, &plan, &pair[1].t, pair[1].q, pair[1].p), TVI_OK);
    columns_same_state(pair);
    ck_assert_int_ge(with.count, (int)(13 / plan.h) + 20 + 4); /* of steps and times, beside events */
    ck_assert(with.count == without.count && memcmp(with.told, without.told, sizeof with.told) == 0);
    tvi_event_free(event);
    columns_close_pair(pair);
}
END_TEST

/* An event that ends the run ends the sums, too: as a run to that time has them. */
START_TEST(stopped)
{
    static const int problems[] = {COLUMNS_KEPLER, COLUMNS_MAGNETIC, COLUMNS_DRIVEN, COLUMNS_REVERSIBLE};
    const double level = 0.3;
    tvi_event *event;
    columns_run pair[2];
    columns_open_pair(pair, &columns_problems[problems[_i]], NULL, 0);
    ck_assert_int_eq(tvi_event_create(&event, pair[0].n, TVI_EITHER, true, first, (void *)&level), TVI_OK);
    const tvi_event *const events[] = {event};
    tvi_chaos to_event = {0}, to_time = {0};
    tvi_run_plan plan = {.h = pair[0].problem->h, .steps = 1000, .events = events, .event_count = 1};
    ck_assert_int_eq(tvi_run_chaos(pair[0].it, &plan, &to_event, &pair[0].t, pair[0].q, pair[0].p), TVI_ESTOPPED);
    ck_assert(to_event.time == pair[0].t && pair[0].t > 0);
    plan = (tvi_run_plan){.h = pair[0].problem->h, .t_end = pair[0].t, .has_t_end = true};
    go(&pair[1], &plan, &to_time);
    expect_sums(pair[0].problem->name, &to_event, &to_time);
    tvi_event_free(event);
    columns_close_pair(pair);
}
END_TEST

static int stop_at_seven(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    (void)member, (void)t, (void)q, (void)p, (void)ctx;
    return which == 7;
}

/* A step that an observer ends the run at counts once; a run of no steps leaves zeros. */
START_TEST(stopped_at_a_step)
{
    columns_run run;
    columns_open(&run, &columns_problems[COLUMNS_KEPLER], NULL, 0);
    tvi_chaos chaos = {.steps = 3};
    tvi_run_plan plan = {.h = 0.125, .t_end = 5, .has_t_end = true, .at_step = stop_at_seven};
    ck_assert_int_eq(tvi_run_chaos(run.it, &plan, &chaos, &run.t, run.q, run.p), TVI_ESTOPPED);
    ck_assert(chaos.steps == 7 && chaos.time == run.t && isfinite(chaos.megno));
    plan.t_end = run.t;
    go(&run, &plan, &chaos);
    ck_assert(chaos.steps == 0 && chaos.time == 0 && chaos.megno == 0 && chaos.t_start == run.t);
    columns_close(&run);
}
END_TEST

/* A run that goes on back to its start has undone its sums, and past it has those of a run that begins there. */
START_TEST(back_at_start)
{
    columns_run run;
    columns_open(&run, &columns_problems[COLUMNS_KEPLER], NULL, 0);
    double D[COLUMNS_MOST_ROWS] = {0};
    tvi_chaos chaos = {0};
    tvi_run_plan plan = {.h = 0.125, .steps = 20, .D = D, .columns = 1};
    go(&run, &plan, &chaos);
    plan.h = -0.125, plan.steps = 19;
    go(&run, &plan, &chaos);
    ck_assert(chaos.steps == 39 && chaos.time == 0.125);
    plan.steps = 1;
    go(&run, &plan, &chaos);
    ck_assert(run.t == 0 && chaos.steps == 0 && chaos.growth == 0 && chaos.y == 0 && chaos.megno == 0);
    plan.steps = 20;
    go(&run, &plan, &chaos);
    ck_assert(run.t == -2.5 && chaos.time == 2.5 && chaos.steps == 20);
    ck_assert(isfinite(chaos.megno) && isfinite(chaos.y) && isfinite(chaos.lyapunov));
    columns_close(&run);
}
END_TEST

/* The vector has the bits of a column that tvi_run moves at once, and is at its end in the user's D. */
START_TEST(moved_at_once)
{
    columns_run pair[2];
    columns_open_pair(pair, &columns_problems[_i], NULL, 0);
    double D[COLUMNS_MOST_ROWS] = {0}, of_plain[COLUMNS_MOST_ROWS];
    tvi_chaos chaos = {0};
    tvi_run_plan plan = {.h = pair[0].problem->h, .D = D, .columns = 1};
    go(&pair[0], &plan, &chaos);
    memcpy(of_plain, D, sizeof D);
    plan.steps = 100;
    go(&pair[0], &plan, &chaos);
    ck_assert(memcmp(of_plain, D, sizeof D) != 0);
    plan.D = of_plain, plan.columns_at_once = true;
    ck_assert_int_eq(tvi_run(pair[1].it, &plan, &pair[1].t, pair[1].q, pair[1].p), TVI_OK);
    ck_assert(memcmp(of_plain, D, sizeof D) == 0);
    columns_close_pair(pair);
}
END_TEST

/* In several calls, with the vector that the library makes of zeros: the same bits. */
START_TEST(cut)
{
    columns_run pair[2];
    columns_open_pair(pair, &columns_problems[_i], NULL, 0);
    pair[0].t = pair[1].t = 3;
    const tvi_chaos wanted = chaos_of(&pair[0], 3000);
    double D[COLUMNS_MOST_ROWS] = {0};
    tvi_chaos chaos = {.size = sizeof chaos};
    tvi_run_plan plan = {.h = pair[1].problem->h, .D = D, .columns = 1};
    for (long done = 0, steps = 1; done < 3000; done += steps, steps = done < 1000 ? 333 : 3000 - done) {
        plan.steps = steps;
        go(&pair[1], &plan, &chaos);
    }
    columns_same_state(pair);
    same_chaos(&chaos, &wanted);
    plan.D = NULL, plan.columns = 0, plan.steps = 1;
    go(&pair[1], &plan, &chaos);
    ck_assert(chaos.steps == 1 && chaos.size == sizeof chaos && chaos.t_start == pair[0].t);
    columns_close_pair(pair);
}
END_TEST

/* ---- The vector -------------------------------------------------------------------------------------------------- */

static jet scaled_kepler(const jet q[], jet t, void *ctx)
{
    (void)t;
    return jet_mul(-*(const double *)ctx, jet_pow(jet_dot(q, q, 2), -0.5));
}

static tvi_chaos chaos_of_mass(double mass, double D[5])
{
    const double masses[] = {mass, mass};
    double t = 0, q[] = {1, 0}, p[] = {0, 0.8 * mass};
    tvi_system *system;
    tvi_integrator *it;
    tvi_chaos chaos = {0};
    ck_assert_int_eq(tvi_system_potential(&system, 2, masses, scaled_kepler, &mass), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&it, system, NULL), TVI_OK);
    tvi_run_plan plan = {.h = 0.25, .D = D, .columns = 1};
    ck_assert_int_eq(tvi_run_chaos(it, &plan, &chaos, &t, q, p), TVI_OK);
    ck_assert(D[0] == 0 && D[1] == 0 && D[2] / mass > 0.2 && D[3] / mass < -0.5);
    plan.D = NULL, plan.columns = 0, plan.steps = 400;
    ck_assert_int_eq(tvi_run_chaos(it, &plan, &chaos, &t, q, p), TVI_OK);
    tvi_integrator_free(it);
    tvi_system_free(system);
    return chaos;
}

/* Powers of two as masses leave all bits, of masses 1e-30, too. */
START_TEST(masses)
{
    const tvi_chaos one = chaos_of_mass(1, (double[5]){0}), light = chaos_of_mass(0x1p-100, (double[5]){0});
    same_chaos(&one, &light);
}
END_TEST

/* Vectors of lengths whose squares are no doubles. */
START_TEST(lengths)
{
    columns_run pair[2];
    for (int exponent = -600; exponent <= 600; exponent += 1200) {
        double D[5] = {0.1, 0.2, 0.3, 0.4}, of_scale[5];
        tvi_chaos chaos = {0}, of_scaled = {0};
        for (int i = 0; i < 5; i++) of_scale[i] = ldexp(D[i], exponent);
        columns_open_pair(pair, &columns_problems[COLUMNS_CHAOTIC], NULL, 0);
        tvi_run_plan plan = {.h = 0.5, .steps = 100, .D = D, .columns = 1};
        go(&pair[0], &plan, &chaos);
        plan.D = of_scale;
        go(&pair[1], &plan, &of_scaled);
        expect_sums("a scaled vector", &of_scaled, &chaos);
        ck_assert(fabs(of_scale[0]) < 1e4);
        columns_close_pair(pair);
    }
}
END_TEST

START_TEST(refusals)
{
    columns_run run;
    columns_open(&run, &columns_problems[COLUMNS_CHAOTIC], NULL, 0);
    double t = 0, *q = run.q, *p = run.p, D[10] = {[4] = 1};
    tvi_chaos chaos = {0}, other = {.size = 1};
    tvi_run_plan plan = {.h = 0.5, .steps = 1}, none = {0};
    refused("integrator is NULL", tvi_run_chaos(NULL, &plan, &chaos, &t, q, p), TVI_EINVAL);
    refused("plan is NULL", tvi_run_chaos(run.it, NULL, &chaos, &t, q, p), TVI_EINVAL);
    refused("chaos is NULL", tvi_run_chaos(run.it, &plan, NULL, &t, q, p), TVI_EINVAL);
    refused("t is NULL", tvi_run_chaos(run.it, &plan, &chaos, NULL, q, p), TVI_EINVAL);
    refused("size", tvi_run_chaos(run.it, &plan, &other, &t, q, p), TVI_EINVAL);
    refused("h is 0", tvi_run_chaos(run.it, &none, &chaos, &t, q, p), TVI_EINVAL);
    plan.D = D, plan.columns = 2;
    refused("D has 2 columns", tvi_run_chaos(run.it, &plan, &chaos, &t, q, p), TVI_EINVAL);
    plan.columns = 1;
    refused("D has no length", tvi_run_chaos(run.it, &plan, &chaos, &t, q, p), TVI_EINVAL);
    D[2] = INFINITY;
    refused("row 2 of D", tvi_run_chaos(run.it, &plan, &chaos, &t, q, p), TVI_ENONFINITE);
    ck_assert(t == 0 && tvi_integrator_stats(run.it)->steps == 0);
    columns_close(&run);
}
END_TEST

Suite *suite_chaos(void)
{
    Suite *suite = suite_create("chaos");
    TCase *tests = tcase_create("chaos");
    tcase_set_timeout(tests, 60);
    tcase_add_loop_test(tests, sums, 0, GRADIENT_PROBLEMS + 1);
    tcase_add_loop_test(tests, order_and_chaos, 0, 4);
    tcase_add_loop_test(tests, same_run, 0, COLUMNS_PROBLEMS);
    tcase_add_loop_test(tests, stopped, 0, 4);
    tcase_add_test(tests, stopped_at_a_step);
    tcase_add_test(tests, back_at_start);
    tcase_add_loop_test(tests, moved_at_once, 0, COLUMNS_PROBLEMS);
    tcase_add_loop_test(tests, cut, 0, COLUMNS_PROBLEMS);
    tcase_add_test(tests, masses);
    tcase_add_test(tests, lengths);
    tcase_add_test(tests, refusals);
    suite_add_tcase(suite, tests);
    return suite;
}
