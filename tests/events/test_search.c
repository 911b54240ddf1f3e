/* test_search.c - Tests the search along the curve: that it looks at the states that the curve has, and finds what is
 * there. */
#include "events.h"
#include "integrator/inside_step.h"
#include "runs.h"
#include "integrator/inside_step.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST_TOLD = 256 };
static const double PI = 3.14159265358979323846;

typedef struct {
    int count, n, which[MOST_TOLD];
    point at[MOST_TOLD];
    run *moved; /* what the observer of steps moves */
    int moves;
    long steps;
} diary;

static int note_event(int which, double t, const double q[], const double p[], void *ctx)
{
    diary *d = ctx;
    ck_assert_int_lt(d->count, MOST_TOLD);
    d->which[d->count] = which;
    point *x = &d->at[d->count++];
    *x = (point){.t = t};
    memcpy(x->q, q, (size_t)d->n * sizeof *q);
    memcpy(x->p, p, (size_t)d->n * sizeof *p);
    return 0;
}

/* The events of a run, which are freed; the observer may be NULL. */
static void watch(run *r, double h, long steps, tvi_event *events[], int count, tvi_observer *observer, diary *d)
{
    d->n = tvi_system_dimension(r->system);
    ck_assert_int_eq(tvi_integrate_events(r->integrator, h, steps, (const tvi_event *const *)events, count, &r->x.t,
                                          r->x.q, r->x.p, observer, note_event, d),
                     TVI_OK);
    for (int i = 0; i < count; i++) tvi_event_free(events[i]);
}

static tvi_event *event_of(int n, tvi_direction direction, tvi_event_fn *g, void *ctx)
{
    tvi_event *event = NULL;
    ck_assert_int_eq(tvi_event_create(&event, n, direction, false, g, ctx), TVI_OK);
    return event;
}

/* ---- Samples ----------------------------------------------------------------------------------------------------- */

/* For every method and form, forward and back, they are the states of tvi_dense, the last one that of the step. */
START_TEST(samples_are_the_curve)
{
    const pairing *x = &pairings[_i / 2];
    const int n = x->scene->n, end = TVI_SAMPLES - 1;
    run r = run_open(x->scene, x->method, x->order);
    const tvi_component_range all[] = {{0, n}, {0, n}}, last[] = {{n - 1, n}, {n - 1, n}};
    double sample[2 * MOST_N + 1][TVI_SAMPLES], now[2 * MOST_N + 1], start[2 * MOST_N];
    double part[2 * MOST_N + 1][TVI_SAMPLES];
    for (int step = 0; step < 5; step++) {
        const double t = r.x.t, h = (_i % 2 ? -1 : 1) * x->h * (1 + 0.25 * (step == 3));
        memcpy(start, r.x.q, (size_t)n * sizeof *start);
        memcpy(start + n, r.x.p, (size_t)n * sizeof *start);
        ck_assert_int_eq(run_steps(&r, h, 1), TVI_OK);
        tvi_sample_dense_output(r.integrator, all, sample[0]);
        tvi_sample_dense_output(r.integrator, last, part[0]);
        for (int i = n - 1; i < 2 * n; i += n) ck_assert_mem_eq(part[i], sample[i], sizeof *part);
        ck_assert_mem_eq(part[2 * n], sample[2 * n], sizeof *part);
        for (int k = 0; k < TVI_SAMPLES; k++) {
            const double theta = (k + 1) / (double)TVI_SAMPLES;
            ck_assert_int_eq(tvi_dense(r.integrator, theta, now, now + n), TVI_OK);
            for (int i = 0; i < 2 * n; i++)
                ck_assert_double_eq_tol(sample[i][k], now[i],
                                        4 * DBL_EPSILON * (fabs(now[i]) + fabs(now[i] - start[i])));
            ck_assert_double_eq_tol(sample[2 * n][k], t + theta * h, 2 * DBL_EPSILON * fabs(r.x.t));
        }
        for (int i = 0; i < n; i++) ck_assert(sample[i][end] == r.x.q[i] && sample[n + i][end] == r.x.p[i]);
        ck_assert(sample[2 * n][end] == r.x.t);
    }
    run_close(&r);
}
END_TEST

/* ---- Rates ------------------------------------------------------------------------------------------------------- */

/* V = t q_0 q_1^2 with unequal masses. */
static jet pulled(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    return jet_mul(t, jet_mul(q[0], jet_sqr(q[1])));
}

static const double pulled_masses[] = {0.5, 3}, pulled_q[] = {0.7, -0.4}, pulled_p[] = {0.3, 1.1};
static const scene with_time = {
    .n = 2, .mass = pulled_masses, .potential = pulled, .q = pulled_q, .p = pulled_p, .energy_scale = 1};

/* They are the differences of steps forth and back, of systems with masses, of Hamiltonians and with the time; a
 * Lagrangian has none. */
START_TEST(rates_are_those_of_steps)
{
    const scene *const scenes_of[] = {&with_time,        &scene_vortices, &scene_nonseparable,
                                      &scene_degenerate, &scene_magnetic, &scene_double_pendulum};
    const scene *s = scenes_of[_i];
    const int n = s->n;
    double x[2 * MOST_N + 1], rate[2 * MOST_N], before[2 * MOST_N], after[2 * MOST_N];
    run r = run_open(s, NULL, 0);
    const double h = 1e-4;
    ck_assert_int_eq(run_steps(&r, 0.1, 1), TVI_OK);
    memcpy(x, r.x.q, (size_t)n * sizeof *x);
    memcpy(x + n, r.x.p, (size_t)n * sizeof *x);
    x[2 * n] = r.x.t;
    const tvi_system *system = r.integrator->stepped;
    const bool has_masses = system->form == TVI_SEPARABLE;
    double q[MOST_N + 1];
    memcpy(q, x, (size_t)n * sizeof *q);
    q[n] = r.x.t;
    if (system->form != TVI_LAGRANGIAN) {
        ck_assert(tvi_integrator_compute_field(r.integrator, q, x + n));
        const double *field = r.integrator->guard.field_block;
        const int *output = system->field_values->output_slot;
        for (int i = 0; i < n; i++) {
            rate[i] = has_masses ? x[n + i] / system->mass[i] : field[output[n + i]];
            rate[n + i] = has_masses ? field[output[i]] : -field[output[i]];
        }
        for (int side = -1; side <= 1; side += 2) {
            double t = x[2 * n], *end = side < 0 ? before : after;
            memcpy(end, x, 2 * (size_t)n * sizeof *end);
            ck_assert_int_eq(tvi_step(r.integrator, side * h, &t, end, end + n), TVI_OK);
        }
        for (int i = 0; i < 2 * n; i++)
            ck_assert_double_eq_tol(rate[i], (after[i] - before[i]) / (2 * h), 1e-6 * fabs(rate[i]) + 1e-9);
    }
    run_close(&r);
}
END_TEST

/* ---- Against references ------------------------------------------------------------------------------------------ */

static jet first(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return q[0];
}

/* The event of scene_henon_heiles_12, which rises through q_0 = 0: t, q_1, p_1, by a Taylor series of degree 40 in 40
 * digits. */
static const double section[][3] = {
    {6.026298281485124888539, -0.209883742713856329489, -0.03135960702652998700805},
    {12.90307573619915099485, -0.1857192566654416049984, 0.1491832346835381331566},
    {19.77806621432376301724, -0.0692794942371717090174, 0.2963908323904526224157},
    {26.37860743960973776183, -0.004593095808821903046159, 0.3596696506591884255367},
    {32.28840163352512784436, -0.2390932563253695149925, 0.2923765378876354064901},
    {37.4893502383948667534, -0.2153615044666691803138, -0.3133480370956023459197},
    {43.46017366416601782761, -0.002852913134223170859612, -0.3569114827301775981321},
    {50.08399644105088867368, -0.07687752571723549544114, -0.2906483021680416270229},
    {56.96626033764750765414, -0.1894994984504500811212, -0.1385384307700922192653},
    {63.84101484631632041232, -0.2090719653308288580163, 0.04166978811185967161103},
    {70.73598448273795057067, -0.1473332878460655874653, 0.2205009004763236283336},
    {77.52779911852245767635, -0.02458075389305673686862, 0.3281863836152415195864},
    {83.92412931993069233582, -0.05063081672279457190557, 0.3729213255959250987847},
    {89.40762548370856864667, -0.3506026751217770582464, 0.04049886352749175282665},
    {94.799620754042689727, -0.07401263962984887373862, -0.3722534963327885107123},
};
enum { CROSSINGS = sizeof section / sizeof *section };

/* Times and states to twelve digits. */
START_TEST(crossings_of_the_section)
{
    static const struct {
        const char *method;
        int order;
        double h;
    } rows[] = {
        {NULL, 0, 0.25}, {NULL, 0, 0.3125}, {"galerkin", 20, 0.5}, {"midpoint", 20, 0.25}, {"taylor", 20, 0.25}};
    static diary d;
    run r = run_open(&scene_henon_heiles_12, rows[_i].method, rows[_i].order);
    tvi_event *event = event_of(2, TVI_RISING, first, NULL);
    d = (diary){0};
    watch(&r, rows[_i].h, lround(95 / rows[_i].h), &event, 1, NULL, &d);
    ck_assert_int_eq(d.count, CROSSINGS);
    for (int i = 0; i < CROSSINGS; i++) {
        ck_assert_double_eq_tol(d.at[i].t, section[i][0], 1e-12 * section[i][0]);
        ck_assert_double_eq_tol(d.at[i].q[0], 0, 1e-15);
        ck_assert_double_eq_tol(d.at[i].q[1], section[i][1], 1e-12);
        ck_assert_double_eq_tol(d.at[i].p[1], section[i][2], 1e-12);
    }
    run_close(&r);
}
END_TEST

static jet radial(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_dot(q, p, 2);
}

/* The pericentres of scene_kepler, (k + 1/2) T with T = 2 pi a^(3/2), a = 1/1.36. */
START_TEST(pericentres)
{
    static diary d;
    const double T = 2 * PI * pow(1.36, -1.5);
    run r = run_open(&scene_kepler, NULL, 0);
    tvi_event *event = event_of(2, TVI_RISING, radial, NULL);
    d = (diary){0};
    watch(&r, 0.125, 800, &event, 1, NULL, &d);
    ck_assert_int_eq(d.count, 25);
    for (int k = 0; k < d.count; k++) {
        ck_assert_double_eq_tol(d.at[k].t, (k + 0.5) * T, 1e-12 * (k + 0.5) * T);
        ck_assert_double_eq_tol(hypot(d.at[k].q[0], d.at[k].q[1]), 2 / 1.36 - 1, 1e-13);
    }
    run_close(&r);
}
END_TEST

/* ---- From step to step ------------------------------------------------------------------------------------------- */

/* The caller takes a part of the state, number `moves`, to the other side, which is no step. */
static int move_across(long step, double t, const double q[], const double p[], void *ctx)
{
    diary *d = ctx;
    point *x = &d->moved->x;
    (void)t, (void)q, (void)p;
    d->steps = step;
    if (step % 3 != 0) return 0;
    if (d->moves == 0) x->q[0] = -x->q[0];
    else if (d->moves == 1) x->p[1] = -x->p[1];
    else x->t = 1 - x->t;
    return 0;
}

/* q_0, p_1, or t - 1/2. */
static jet side(const jet q[], const jet p[], jet t, void *ctx)
{
    const int moves = *(const int *)ctx;
    return moves == 0 ? q[0] : moves == 1 ? p[1] : jet_sub(t, 0.5);
}

/* The next step does not begin with the value that the last one ended with: g is that of its own start. No step
 * crosses. */
START_TEST(moved_between_steps)
{
    static diary d;
    int moves = _i;
    run r = run_open(&scene_kepler, NULL, 0);
    tvi_event *events[] = {event_of(2, TVI_EITHER, side, &moves), event_of(2, TVI_EITHER, side, &moves)};
    d = (diary){.moved = &r, .moves = moves};
    watch(&r, 0.03125, 9, events, 2, move_across, &d);
    ck_assert_int_eq(d.steps, 9);
    ck_assert_int_eq(d.count, 0);
    run_close(&r);
}
END_TEST

/* ---- Many at once ------------------------------------------------------------------------------------------------ */

/* sin (speed t - phase). */
static jet wave(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *speed_phase = ctx;
    (void)q, (void)p;
    return jet_sin(jet_sub(jet_mul(speed_phase[0], t), speed_phase[1]));
}

/* More roots in a step than there is room for their states: all are told, in order, each in the state of its time. */
START_TEST(many_states_in_one_step)
{
    enum { WAVES = 24 };
    static const int orders[] = {16, 12, 8, 4, 2};
    const int order = orders[_i / 2];
    const double speed = _i % 2 ? 9 : 47; /* with guesses that are good, and not */
    static diary d;
    run r = run_open(&scene_kepler, "galerkin", order);
    tvi_event *events[WAVES];
    double phase[WAVES];
    for (int i = 0; i < WAVES; i++) {
        double speed_phase[] = {speed, phase[i] = 0.1 * i + 0.05};
        events[i] = event_of(2, TVI_EITHER, wave, speed_phase);
    }
    d = (diary){0};
    watch(&r, 0.25, 1, events, WAVES, NULL, &d);
    ck_assert_int_ge(d.count, _i % 2 ? 20 : 80);
    for (int i = 0; i < d.count; i++) {
        run same = run_open(&scene_kepler, "galerkin", order);
        const double turns = (speed * d.at[i].t - phase[d.which[i]]) / PI;
        ck_assert_double_eq_tol(turns, round(turns), 1e-14);
        ck_assert(i == 0 || d.at[i].t > d.at[i - 1].t);
        ck_assert_int_eq(run_steps(&same, d.at[i].t, 1), TVI_OK);
        for (int k = 0; k < 2; k++) {
            ck_assert_double_eq_tol(d.at[i].q[k], same.x.q[k], 4 * DBL_EPSILON);
            ck_assert_double_eq_tol(d.at[i].p[k], same.x.p[k], 4 * DBL_EPSILON);
        }
        run_close(&same);
    }
    run_close(&r);
}
END_TEST

/* A wave whose root the samples show nearly to roundoff, more and less: the state is that of its time. */
START_TEST(states_of_smooth_waves)
{
    for (double speed = 1; speed < 12; speed *= 1.03) {
        static diary d;
        double speed_phase[] = {speed, 0.1 * speed};
        run r = run_open(&scene_kepler, "galerkin", 16), same = run_open(&scene_kepler, "galerkin", 16);
        tvi_event *event = event_of(2, TVI_RISING, wave, speed_phase);
        d = (diary){0};
        watch(&r, 0.25, 1, &event, 1, NULL, &d);
        ck_assert_int_eq(d.count, 1);
        ck_assert_int_eq(run_steps(&same, d.at[0].t, 1), TVI_OK);
        for (int k = 0; k < 2; k++) {
            ck_assert_double_eq_tol(d.at[0].q[k], same.x.q[k], 4 * DBL_EPSILON);
            ck_assert_double_eq_tol(d.at[0].p[k], same.x.p[k], 4 * DBL_EPSILON);
        }
        run_close(&r);
        run_close(&same);
    }
}
END_TEST

/* ---- Least |g| --------------------------------------------------------------------------------------------------- */

/* (t - T)^4 - w^4, and the same with -w^4: no parabola. */
static jet flat_dip(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *T_w = ctx, w = T_w[1];
    (void)q, (void)p;
    return jet_sub(jet_sqr(jet_sqr(jet_sub(t, T_w[0]))), w * w * w * fabs(w));
}

START_TEST(flat_dips_are_followed)
{
    static const double places[] = {0.4, 0.26, 0.2501, 0.25, 0.2499, 0.03125, 0.499999};
    for (int sign = -1; sign <= 1; sign += 2) {
        static diary d;
        run r = run_open(&scene_pendulum, "midpoint", 4);
        double T_w[] = {places[_i], sign * 3e-3};
        tvi_event *event = event_of(1, TVI_EITHER, flat_dip, T_w);
        d = (diary){0};
        watch(&r, 0.25, 3, &event, 1, NULL, &d);
        ck_assert_int_eq(d.count, sign < 0 ? 0 : 2);
        for (int i = 0; i < d.count; i++) ck_assert_double_eq_tol(d.at[i].t, T_w[0] + (i ? 1 : -1) * T_w[1], 1e-13);
        run_close(&r);
    }
}
END_TEST

/* (t - a) (t - b), a = 0: the run starts on the first zero, and the second one lies soon after, between two samples. */
static jet both(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)p;
    return jet_mul(t, jet_sub(t, *(const double *)ctx));
}

START_TEST(soon_after_the_start)
{
    static const double soon[] = {0.01, 0.001, 0.03};
    static diary d;
    double b = soon[_i];
    run r = run_open(&scene_pendulum, NULL, 0);
    tvi_event *event = event_of(1, TVI_EITHER, both, &b);
    d = (diary){0};
    watch(&r, 0.25, 2, &event, 1, NULL, &d);
    ck_assert_int_eq(d.count, 1);
    ck_assert_double_eq_tol(d.at[0].t, b, 1e-16);
    run_close(&r);
}
END_TEST

Suite *suite_search(void)
{
    Suite *suite = suite_create("search");
    TCase *tcase = tcase_create("search");
    tcase_add_loop_test(tcase, samples_are_the_curve, 0, 2 * PAIRINGS);
    tcase_add_loop_test(tcase, rates_are_those_of_steps, 0, 6);
    tcase_add_loop_test(tcase, crossings_of_the_section, 0, 5);
    tcase_add_test(tcase, pericentres);
    tcase_add_loop_test(tcase, moved_between_steps, 0, 3);
    tcase_add_loop_test(tcase, many_states_in_one_step, 0, 10);
    tcase_add_test(tcase, states_of_smooth_waves);
    tcase_add_loop_test(tcase, flat_dips_are_followed, 0, 7);
    tcase_add_loop_test(tcase, soon_after_the_start, 0, 3);
    suite_add_tcase(suite, tcase);
    return suite;
}
