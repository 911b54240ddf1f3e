/* test_guard.c - steps that are too large are refused, and steps that are right are not: a ladder of steps, each step
 * beside one that is not looked at (docs/stability.md). */
#include "stability.h"

#include <math.h>
#include <string.h>

/* The part of the energy that a step may change; and how close to the solution, relative to the largest coordinate and
 * momentum, a step is right. */
static const double WRONG = 0.05, RIGHT = 1e-3;

static const struct {
    const hard_case *of;
    double period; /* of 6 to 3200 steps */
} climbed[] = {{&kepler_60, 6.283}, {&kepler_90, 6.283}, {&kepler_99, 6.283}, {&henon_heiles_6, 6.283}};
enum { CLIMBED = sizeof climbed / sizeof *climbed };

static const hard_method climbers[] = {
    {"galerkin", 16, false}, {"galerkin", 8, false}, {"midpoint", 16, false}, {"midpoint", 8, false},
    {"poincare", 16, false}, {"poincare", 8, false}, {"right", 8, false},     {"start", 16, false},
    {"both-ends", 8, false}, {"taylor", 16, false},  {"tvi", 8, false},
};
enum { CLIMBERS = sizeof climbers / sizeof *climbers };

static tvi_integrator *open_integrator(const tvi_system *system, const hard_method *m, double max_tail)
{
    tvi_options options;
    tvi_integrator *integrator;
    ck_assert(hard_options(m, &options));
    options.max_tail = max_tail;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    return integrator;
}

static double energy_of(const tvi_system *system, const hard_state *x)
{
    double H;
    return tvi_energy(system, x->t, x->q, x->p, &H) == TVI_OK ? H : INFINITY;
}

static double relative(int n, const double a[], const double b[])
{
    double apart = 0, size = 0;
    for (int i = 0; i < n; i++) apart = fmax(apart, fabs(a[i] - b[i])), size = fmax(size, fabs(b[i]));
    return apart / size;
}

/* The solution after h, by short steps of the default method: until twice as many agree. */
static bool solve(const tvi_system *system, int n, const hard_state *from, double h, hard_state *to)
{
    static const hard_method accurate = {"galerkin", 16, false};
    tvi_integrator *integrator = open_integrator(system, &accurate, 0);
    hard_state last = {.t = NAN};
    bool agrees = false;
    for (long parts = 32; parts <= 8192 && !agrees; parts *= 4) {
        *to = *from;
        const tvi_status status = tvi_integrate(integrator, h / (double)parts, parts, &to->t, to->q, to->p, NULL, NULL);
        agrees = status == TVI_OK && isfinite(last.t) && relative(n, to->q, last.q) < 1e-5 &&
                 relative(n, to->p, last.p) < 1e-5;
        last = *to;
        if (status != TVI_OK) last.t = NAN;
    }
    tvi_integrator_free(integrator);
    return agrees;
}

typedef struct {
    const tvi_system *system;
    tvi_integrator *looks, *blind;
    int n, wrong;
    const char *name;
} pair_of;

/* One step of both. Where one fails, the run goes on from the solution. */
static bool compare_step(pair_of *both, double h, hard_state *x)
{
    hard_state seen = *x, made = *x, solution;
    const tvi_status status = tvi_step(both->looks, h, &seen.t, seen.q, seen.p);
    const tvi_status blind = tvi_step(both->blind, h, &made.t, made.q, made.p);
    const double before = energy_of(both->system, x), after = blind == TVI_OK ? energy_of(both->system, &made) : before;
    if (status == TVI_OK) {
        ck_assert_msg(fabs(after - before) <= WRONG * fabs(before), "%s, h = %g: %g to %g, tail %g", both->name, h,
                      before, after, tvi_integrator_stats(both->looks)->tail);
        *x = seen;
        return true;
    }
    both->wrong += status == TVI_ETOOLARGE;
    ck_assert(memcmp(&seen, x, sizeof seen) == 0);
    if (!solve(both->system, both->n, x, h, &solution)) return false;
    if (status == TVI_ETOOLARGE) {
        const bool is_right =
            relative(both->n, made.q, solution.q) < RIGHT && relative(both->n, made.p, solution.p) < RIGHT;
        ck_assert_msg(!is_right || fabs(after - before) > WRONG * fabs(before), "%s, h = %g: right", both->name, h);
    }
    *x = solution;
    return true;
}

START_TEST(ladder)
{
    const hard_case *c = climbed[_i / CLIMBERS].of;
    const hard_method *m = &climbers[_i % CLIMBERS];
    tvi_system *system;
    ck_assert_int_eq(hard_system(c, &system), TVI_OK);
    pair_of both = {.system = system, .n = c->scene.n, .name = m->name};
    for (double steps = 6; steps <= 3200; steps *= 2.6) {
        hard_state x = start_of(c);
        both.looks = open_integrator(system, m, 0);
        both.blind = open_integrator(system, m, -1);
        for (int step = 0; step < 60; step++)
            if (!compare_step(&both, climbed[_i / CLIMBERS].period / steps, &x)) break;
        tvi_integrator_free(both.looks);
        tvi_integrator_free(both.blind);
    }
    if (c == &kepler_99) ck_assert_int_gt(both.wrong, 0); /* there are such steps */
    tvi_system_free(system);
}
END_TEST

/* The options: none is refused, or all but the smallest; what is counted, and what a reset forgets. */
START_TEST(options_of_the_guard)
{
    static const hard_method method = {"galerkin", 8, false};
    tvi_system *system;
    const hard_state start = start_of(&kepler_99);
    ck_assert_int_eq(hard_system(&kepler_99, &system), TVI_OK);
    tvi_integrator *strict = open_integrator(system, &method, 1e-9), *blind = open_integrator(system, &method, -1);
    hard_state x = start;
    tvi_integrator *usual = open_integrator(system, &method, 0);
    ck_assert_double_eq(tvi_integrator_options(usual)->max_tail, TVI_MAX_TAIL);
    tvi_integrator_free(usual);
    ck_assert_int_eq(tvi_step(strict, 0.1, &x.t, x.q, x.p), TVI_ETOOLARGE);
    ck_assert(memcmp(&x, &start, sizeof x) == 0);
    const double tail = tvi_integrator_stats(strict)->largest_tail;
    ck_assert_double_gt(tail, 1e-9);
    ck_assert_int_eq(tvi_step(strict, 1e-4, &x.t, x.q, x.p), TVI_OK);
    ck_assert_double_eq(tvi_integrator_stats(strict)->largest_tail, tail);
    tvi_integrator_reset(strict);
    ck_assert_double_eq(tvi_integrator_stats(strict)->largest_tail, 0);
    for (int step = 0; step < 40; step++) (void)!tvi_step(blind, 0.5, &x.t, x.q, x.p);
    ck_assert_double_gt(tvi_integrator_stats(blind)->largest_tail, 0.05);
    tvi_integrator_free(strict);
    tvi_integrator_free(blind);
    tvi_system_free(system);
}
END_TEST

Suite *suite_guard(void)
{
    Suite *suite = suite_create("guard");
    TCase *tcase = tcase_create("guard");
    tcase_set_timeout(tcase, 120);
    tcase_add_loop_test(tcase, ladder, 0, CLIMBED * CLIMBERS);
    tcase_add_test(tcase, options_of_the_guard);
    suite_add_tcase(suite, tcase);
    return suite;
}
