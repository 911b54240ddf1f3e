/* test_cuts.c - Tests that however a run is cut into calls, each event is told once (tvi_runs.h): 2000 runs at random,
 * of all forms of systems, fixed and rescaled steps and steps to a tolerance, so many steps, runs to a time and at
 * times, with and without tangent vectors, integrators and ensembles, forward and back, with steps that divide the
 * periods of strobes, times up to 1.7e9, events that end the run, that come together, that only touch 0 or have a kink
 * there. */
#include "cuts.h"
#include "events.h"
#include "problems/random.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { LOOPS = 20, RUNS = 80, RUNS_TO = 20 };

static uint64_t seed_of(int loop, int k) { return UINT64_C(0x9e3779b97f4a7c15) * (uint64_t)(1000 * loop + k + 1); }

/* ---- Between steps ----------------------------------------------------------------------------------------------- */

static void compare(const notes *whole, const notes *pieces, const random_run *r)
{
    ck_assert_msg(whole->count == pieces->count && whole->status == pieces->status,
                  "%s %s %d, kind %d, h = %g: %d events and %d, %s and %s", r->pair->scene->name, r->pair->method,
                  r->pair->order, (int)r->kind, r->h, whole->count, pieces->count, tvi_status_string(whole->status),
                  tvi_status_string(pieces->status));
    for (int i = 0; i < whole->count; i++) {
        const event_note *a = &whole->note[i], *b = &pieces->note[i];
        const bool is_same = a->member == b->member && a->which == b->which && same_point(&a->x, &b->x);
        ck_assert_msg(is_same && memcmp(a->D, b->D, sizeof a->D) == 0,
                      "%s %s %d, kind %d: event %d at %.17g and %d at %.17g", r->pair->scene->name, r->pair->method,
                      r->pair->order, (int)r->kind, a->which, a->x.t, b->which, b->x.t);
    }
    for (int m = 0; m < whole->members; m++) ck_assert(same_point(&whole->end[m], &pieces->end[m]));
    ck_assert(memcmp(whole->D, pieces->D, sizeof whole->D) == 0);
}

/* Calls of some steps or some times, observers that stop, states saved and loaded: all events and times, with their
 * states and D, and the end are those of one call, bit for bit; also where terminal events end the run, which then goes
 * on, with p or -p. */
START_TEST(cuts_between_steps)
{
    static notes whole, pieces;
    int made = 0, told = 0;
    for (int k = 0; made < RUNS; k++) {
        uint64_t bits = seed_of(_i, k);
        random_run r;
        if (make_run(&r, &bits, true, true)) {
            make_notes(&r, NULL, &whole);
            make_notes(&r, &bits, &pieces);
            compare(&whole, &pieces, &r);
            made++;
            told += whole.count;
        }
        free_run(&r);
    }
    ck_assert_int_gt(told, 4 * RUNS); /* else nothing is seen */
}
END_TEST

/* ---- Cuts that change steps -------------------------------------------------------------------------------------- */

/* Methods whose steps of such a size are right to 1e-12 on these orbits, and the cuts that they serve: runs to times
 * between, runs that an observer of events stops at each of them, or at some, and both of runs to a tolerance. Methods
 * of low order are left out, as what their steps are depends on where they begin; and events that only touch 0. */
static const pairing regular[] = {
    {&scene_kepler, "galerkin", 16, 0.1},    {&scene_kepler, "midpoint", 20, 0.1},
    {&scene_kepler, "poincare", 20, 0.1},    {&scene_kepler, "taylor", 20, 0.1},
    {&scene_pendulum, "galerkin", 12, 0.05}, {&scene_nonseparable, "galerkin", 12, 0.02},
    {&scene_magnetic, "galerkin", 12, 0.05}, {&scene_double_pendulum, "galerkin", 12, 0.005},
};
enum { REGULAR = sizeof regular / sizeof *regular };
typedef enum { CUT_AT_TIMES = 1, CUT_AT_EVENTS = 2 } cuts;

/* To the end, by an integrator or an ensemble of one, in calls that are cut there; 0: in one. */
static void go_to(const random_run *r, unsigned where, uint64_t *bits, notes *to)
{
    point x = start_of_member(r, 0);
    tvi_ensemble *e;
    tvi_integrator *it;
    start_notes(r, to);
    to->by_event = where & CUT_AT_EVENTS;
    ck_assert_int_eq(tvi_ensemble_create(&e, r->system, &r->options, 1, 1), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&it, r->system, &r->options), TVI_OK);
    while (x.t != r->t_end) {
        const double part = where & CUT_AT_TIMES ? number_of(bits) : 1;
        tvi_run_plan plan = plan_of(r, to);
        if (part <= 0.8) plan.t_end = x.t + part * (r->t_end - x.t);
        if (r->members == 0) to->status = tvi_run(it, &plan, &x.t, x.q, x.p);
        else ck_assert_int_eq(tvi_ensemble_run(e, &plan, &x.t, x.q, x.p, &to->status), TVI_OK);
        ck_assert_msg(to->status == TVI_OK || to->status == TVI_ESTOPPED, "%s", tvi_last_error());
        to->stops += to->status == TVI_ESTOPPED;
    }
    to->end[0] = x;
    tvi_ensemble_free(e);
    tvi_integrator_free(it);
}

/* One of the runs that are cut so: to a time, or to a tolerance. */
static bool make_run_to(random_run *r, const pairing *pair, uint64_t *bits)
{
    if (!make_run_of(r, pair, bits, false, false)) return false;
    if (r->kind != BY_TOLERANCE) r->kind = TO_TIME;
    r->tolerance = 1e-15;
    r->t_end = r->t0 + (double)r->steps * r->h;
    if (r->members > 1) r->members = 1;
    return true;
}

/* The same columns, relative to the largest number in them, whose time scale is that of a step of size h. */
static void compare_columns(const notes *a, const notes *b, double near, double h)
{
    double size = 0, apart = 0;
    for (int k = 0; k < 2 * a->n * a->columns; k++) {
        size = fmax(size, fabs(a->D[k]));
        apart = fmax(apart, fabs(a->D[k] - b->D[k]));
    }
    ck_assert_double_le(apart, size * near / h);
}

/* The times of an event, but those at the end. */
static int times_of(const notes *pair, int which, double t_end, double near, double times[])
{
    int count = 0;
    for (int i = 0; i < pair->count; i++)
        if (pair->note[i].which == which && fabs(pair->note[i].x.t - t_end) > near) times[count++] = pair->note[i].x.t;
    return count;
}

/* The same events in the same order, at times that differ by 1e-10 of the time scale of a step, or by what t resolves,
 * which each stop rounds to. */
START_TEST(cuts_that_change_steps)
{
    static notes whole, pieces;
    static double a[MOST_NOTES], b[MOST_NOTES];
    int made = 0, told = 0;
    for (int k = 0; made < RUNS_TO; k++) {
        uint64_t bits = seed_of(LOOPS + _i, k);
        random_run r;
        const pairing *pair = &regular[_i % REGULAR];
        if (make_run_to(&r, pair, &bits)) {
            const double t_end = r.t_end;
            go_to(&r, 0, &bits, &whole);
            go_to(&r, 1 + (unsigned)_i % 3, &bits, &pieces);
            const double near = 1e-10 * pair->h + (2 + pieces.stops) * DBL_EPSILON * fmax(fabs(r.t0), fabs(t_end));
            compare_columns(&whole, &pieces, near, pair->h);
            for (int which = 0; which < r.count; which++) {
                const int count = times_of(&whole, which, t_end, near, a);
                const int again = times_of(&pieces, which, t_end, near, b);
                ck_assert_msg(again == count, "%s %s %d, h = %g from %g, rescaled %d: %d of event %d, cut %d",
                              pair->scene->name, pair->method, pair->order, r.h, r.t0, r.is_rescaled, count, which,
                              again);
                for (int i = 0; i < count; i++) ck_assert_double_eq_tol(a[i], b[i], near);
                told += count;
            }
            made++;
        }
        free_run(&r);
    }
    ck_assert_int_gt(told, RUNS_TO / 2); /* else nothing is seen */
}
END_TEST

Suite *suite_cuts(void)
{
    Suite *suite = suite_create("cuts");
    TCase *tcase = tcase_create("cuts");
    tcase_add_loop_test(tcase, cuts_between_steps, 0, LOOPS);
    tcase_add_loop_test(tcase, cuts_that_change_steps, 0, LOOPS);
    suite_add_tcase(suite, tcase);
    return suite;
}
