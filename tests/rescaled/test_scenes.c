/* test_scenes.c - Tests the scenes of bench/scenes/hard.h against their references; and explicit time: results, ends
 * and events at times of a run whose steps are in s, against steps of equal time. */
#include "hard.h"
#include "rescaled.h"

#include <math.h>
#include <string.h>

/* ---- References -------------------------------------------------------------------------------------------------- */

typedef enum { OWN, AUTOMATIC, FIXED } kind_of_step;

/* The error at the end, the largest of a coordinate, is between least and most. */
static const struct {
    const hard_scene *problem;
    kind_of_step kind;
    double h, least, most;
} ends[] = {
    {&hard_comet, OWN, 0.1176, 1e-8, 6e-8},
    {&hard_comet, OWN, 0.05, 0, 1e-11},
    {&hard_comet, AUTOMATIC, 0.1176, 3e-10, 3e-8},
    {&hard_comet, AUTOMATIC, 0.05, 0, 5e-12},
    {&hard_comet, FIXED, 0.6, 1, 10},
    {&hard_comet, FIXED, 0.075, 5e-4, 5e-3},
    {&hard_sitnikov, OWN, 1, 5e-12, 5e-11},
    {&hard_sitnikov, OWN, 0.5, 0, 1e-12},
    {&hard_three_planets, OWN, 0.7, 2e-10, 2e-9},
    {&hard_three_planets, OWN, 0.4, 0, 6e-11},
    {&hard_three_planets, AUTOMATIC, 1, 1e-7, 1e-6},
    {&hard_three_planets, AUTOMATIC, 0.4, 0, 6e-11},
    {&hard_three_planets, FIXED, 0.0047, 0.1, 10},
    {&hard_pythagorean, OWN, 1.2, 2e-4, 4e-3},
    {&hard_pythagorean, AUTOMATIC, 0.49, 1e-2, 2e-1},
    {&hard_pythagorean, OWN, 0.75, 0, 1e-3},
};
enum { ENDS = sizeof ends / sizeof *ends };

static run open_scene(const hard_scene *problem, kind_of_step kind)
{
    const scene *s = &problem->scene;
    state start = {0};
    tvi_system *system;
    memcpy(start.q, s->q, (size_t)s->n * sizeof *s->q);
    memcpy(start.p, s->p, (size_t)s->n * sizeof *s->p);
    if (kind == FIXED) ck_assert_int_eq(scene_system(s, &system), TVI_OK);
    else system = rescaled_system(s->n, s->mass, s->potential, kind == OWN ? problem->scale : NULL);
    return open_run(system, NULL, 0, &start);
}

static tvi_status run_to(run *r, double h, double t_end)
{
    return tvi_integrate_to(r->integrator, h, t_end, &r->x.t, r->x.q, r->x.p, NULL, NULL);
}

START_TEST(references)
{
    const scene *s = &ends[_i].problem->scene;
    run r = open_scene(ends[_i].problem, ends[_i].kind);
    double error = 0;
    ck_assert_int_eq(run_to(&r, ends[_i].h, s->t_end), TVI_OK);
    for (int i = 0; i < s->n; i++) error = fmax(error, fabs(r.x.q[i] - s->reference[i]));
    ck_assert_msg(error >= ends[_i].least && error <= ends[_i].most, "%s, h = %g: %.2e", s->name, ends[_i].h, error);
    close_run(&r);
}
END_TEST

/* ---- Explicit time ----------------------------------------------------------------------------------------------- */

static const double ACCURACY = 2e-14;

/* The position of Sitnikov's particle at t, by short steps of equal time. */
static state sitnikov_at(double t)
{
    run r = open_scene(&hard_sitnikov, FIXED);
    if (t != 0) ck_assert_int_eq(run_to(&r, copysign(1.0 / 32, t), t), TVI_OK);
    const state at = r.x;
    close_run(&r);
    return at;
}

static void check_state(double t, const double q[], const double p[], double *worst)
{
    const state there = sitnikov_at(t), here = {t, {q[0]}, {p[0]}};
    *worst = fmax(*worst, state_distance(1, &here, &there));
}

static int note_time(long which, double t, const double q[], const double p[], void *ctx)
{
    (void)which;
    check_state(t, q, p, ctx);
    return 0;
}

START_TEST(states_at_times)
{
    const double way = _i ? -1 : 1, times[] = {0, way * 1e-3, way * 0.5, way * 3.141592653589793, way * 17, way * 18.5};
    enum { COUNT = sizeof times / sizeof *times };
    double worst = 0;
    run r = open_scene(&hard_sitnikov, OWN);
    ck_assert_int_eq(tvi_integrate_at(r.integrator, way * 0.4, times, COUNT, &r.x.t, r.x.q, r.x.p, note_time, &worst),
                     TVI_OK);
    ck_assert_double_ge(way * r.x.t, 18.5);
    ck_assert_double_le(worst, ACCURACY);
    close_run(&r);
    r = open_scene(&hard_sitnikov, OWN);
    for (int i = 1; i < COUNT; i++) {
        ck_assert_int_eq(run_to(&r, way * 0.4, times[i]), TVI_OK);
        ck_assert(r.x.t == times[i]);
        check_state(r.x.t, r.x.q, r.x.p, &worst);
    }
    ck_assert_double_le(worst, ACCURACY);
    close_run(&r);
}
END_TEST

static jet crossing(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return q[0];
}

/* Pericentre of the two masses: f a multiple of 2 pi. */
static jet pericentre(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)p, (void)ctx;
    return jet_sin(jet_mul(0.5, t));
}

typedef struct {
    int crossings, pericentres;
    double worst_q, worst_t, worst;
} meetings;

static int meet(int which, double t, const double q[], const double p[], void *ctx)
{
    meetings *m = ctx;
    const double turn = 2 * acos(-1);
    check_state(t, q, p, &m->worst);
    if (which == 0) m->crossings++, m->worst_q = fmax(m->worst_q, fabs(q[0]));
    else m->pericentres++, m->worst_t = fmax(m->worst_t, fabs(t - turn * rint(t / turn)));
    return 0;
}

START_TEST(events)
{
    const double way = _i ? -1 : 1;
    tvi_event *event[2];
    meetings m = {0};
    run r = open_scene(&hard_sitnikov, OWN);
    ck_assert_int_eq(tvi_event_create(&event[0], 1, TVI_EITHER, false, crossing, NULL), TVI_OK);
    ck_assert_int_eq(tvi_event_create(&event[1], 1, TVI_EITHER, false, pericentre, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrate_events(r.integrator, way * 0.4, 120, (const tvi_event *const *)event, 2, &r.x.t,
                                          r.x.q, r.x.p, NULL, meet, &m),
                     TVI_OK);
    ck_assert_int_eq(m.pericentres, (int)floor(fabs(r.x.t) / (2 * acos(-1))));
    ck_assert_int_ge(m.pericentres, 2);
    ck_assert_int_ge(m.crossings, 10);
    ck_assert_double_le(m.worst_q, 2e-15);
    ck_assert_double_le(m.worst_t, 1e-14);
    ck_assert_double_le(m.worst, ACCURACY);
    tvi_event_free(event[0]);
    tvi_event_free(event[1]);
    close_run(&r);
}
END_TEST

Suite *suite_scenes(void)
{
    Suite *suite = suite_create("scenes");
    TCase *tests = tcase_create("references"), *time = tcase_create("explicit time");
    tcase_add_loop_test(tests, references, 0, ENDS);
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(time, states_at_times, 0, 2);
    tcase_add_loop_test(time, events, 0, 2);
    suite_add_tcase(suite, time);
    return suite;
}
