/* cuts.c - see cuts.h. */
#include "cuts.h"
#include "problems/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* ---- Events ------------------------------------------------------------------------------------------------------ */

static jet place(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *c = ctx;
    (void)p, (void)t;
    return jet_mul(c[1], jet_sub(q[0], c[0]));
}

static jet momentum(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *c = ctx;
    (void)q, (void)t;
    return jet_sub(p[0], c[2]);
}

static jet strobe(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *c = ctx; /* c[3] is the period */
    (void)q, (void)p;
    return jet_sin(jet_mul(2 * PI / c[3], t));
}

static jet radial(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(q[0], p[0]);
}

static jet kinked(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *c = ctx;
    (void)t;
    return jet_sub(jet_hypot(jet_sub(q[0], c[0]), jet_mul(0.1, jet_sub(p[0], c[2]))), 0.01);
}

static jet touching(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *c = ctx;
    (void)p, (void)t;
    return jet_sqr(jet_sub(q[0], c[0]));
}

static jet wider(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_add(1, jet_mul(0.1, jet_sqr(q[0])));
}

static int whole(uint64_t *bits, int count) { return (int)(number_of(bits) * count); }

/* An event of some kind, or the one before it once more, to be told at the same time. */
static void make_event(random_run *r, int i, uint64_t *bits, bool wants_touching, bool wants_terminal)
{
    static tvi_event_fn *const kinds[] = {place, momentum, strobe, radial, kinked, touching};
    const scene *s = r->of->scene;
    double *c = r->numbers[i];
    const int kind = whole(bits, 5 + wants_touching);
    const bool is_same = i > 0 && number_of(bits) < 0.2, is_terminal = number_of(bits) < 0.15 && wants_terminal;
    c[0] = s->q[0] + (number_of(bits) - 0.5) * (0.1 + fabs(s->q[0]));
    c[1] = number_of(bits) < 0.5 ? 1 : 3;
    c[2] = s->p[0] + (number_of(bits) - 0.5) * (0.1 + fabs(s->p[0]));
    c[3] = fabs(r->h) * (number_of(bits) < 0.5 ? 1 + whole(bits, 20) : 0.7 + 20 * number_of(bits));
    if (r->kind == BY_TOLERANCE) c[3] *= 20; /* steps are so much larger, and a strobe has to be seen */
    if (is_same) memcpy(c, r->numbers[i - 1], sizeof r->numbers[i]), c[1] = 3;
    const tvi_direction direction = (tvi_direction)(whole(bits, 3) - 1);
    tvi_event_fn *g = is_same ? place : kinds[kind];
    ck_assert_int_eq(tvi_event_create(&r->events[i], s->n, direction, is_terminal, g, c), TVI_OK);
}

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

bool make_run(random_run *r, uint64_t *bits, bool wants_touching, bool wants_terminal)
{
    return make_run_of(r, &pairings[whole(bits, PAIRINGS)], bits, wants_touching, wants_terminal);
}

bool make_run_of(random_run *r, const pairing *of, uint64_t *bits, bool wants_touching, bool wants_terminal)
{
    const double starts[] = {0, 0, 2.4e6, 1.7e9};
    *r = (random_run){.of = of, .kind = (run_kind)whole(bits, RUN_KINDS)};
    r->is_rescaled = number_of(bits) < 0.3;
    r->turns = number_of(bits) < 0.3;
    r->tolerance = pow(10, -6 - 8 * number_of(bits));
    r->h = r->of->h * (0.2 + number_of(bits)) * (number_of(bits) < 0.5 ? -1 : 1);
    r->t0 = number_of(bits) < 0.2 ? 100 * number_of(bits) : starts[whole(bits, 4)];
    r->steps = 1 + whole(bits, 80);
    r->count = 1 + whole(bits, MOST_EVENTS);
    r->members = r->kind == OF_MEMBERS ? (number_of(bits) < 0.5 ? 1 : MOST_MEMBERS) : 1;
    ck_assert_int_eq(tvi_options_named(r->of->method, r->of->order, &r->options), TVI_OK);
    ck_assert_int_eq(scene_system(r->of->scene, &r->base), TVI_OK);
    const bool wants_terminals = wants_terminal && r->kind != OF_MEMBERS;
    for (int i = 0; i < r->count; i++) make_event(r, i, bits, wants_touching, wants_terminals);
    tvi_integrator *it = NULL;
    const bool is_made = !r->is_rescaled || tvi_system_rescaled(&r->system, r->base, wider, NULL) == TVI_OK;
    if (!r->is_rescaled) r->system = r->base;
    bool serves = is_made && tvi_integrator_create(&it, r->system, &r->options) == TVI_OK;
    serves = serves && (r->kind != BY_TOLERANCE || (r->options.method == TVI_TAYLOR && !r->is_rescaled));
    tvi_integrator_free(it);
    return serves;
}

void free_run(random_run *r)
{
    for (int i = 0; i < r->count; i++) tvi_event_free(r->events[i]);
    if (r->system != r->base) tvi_system_free(r->system);
    tvi_system_free(r->base);
}

point start_of_member(const random_run *r, int member)
{
    const scene *s = r->of->scene;
    point x = {.t = r->t0};
    for (int i = 0; i < s->n; i++) x.q[i] = s->q[i] * (1 + 0.01 * member), x.p[i] = s->p[i];
    return x;
}

/* ---- What is told ------------------------------------------------------------------------------------------------ */

static int note(notes *to, int member, int which, double t, const double q[], const double p[])
{
    ck_assert_int_lt(to->count, MOST_NOTES);
    event_note *next = &to->note[to->count++];
    *next = (event_note){.member = member, .which = which, .x = {.t = t}};
    memcpy(next->x.q, q, (size_t)to->n * sizeof *q);
    memcpy(next->x.p, p, (size_t)to->n * sizeof *p);
    return to->by_event;
}

static int take_note(int which, double t, const double q[], const double p[], void *ctx)
{
    return note(ctx, 0, which, t, q, p);
}

int take_member_note(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    return note(ctx, member, which, t, q, p);
}

static int count_step(long step, double t, const double q[], const double p[], void *ctx)
{
    notes *to = ctx;
    (void)t, (void)q, (void)p;
    to->steps = step;
    to->by_observer = step == to->stop_after;
    return to->by_observer;
}

/* ---- One integrator ---------------------------------------------------------------------------------------------- */

/* The integrator becomes another one, with its state. */
static tvi_integrator *move_on(const random_run *r, tvi_integrator *it)
{
    size_t size = 0;
    tvi_integrator *other;
    ck_assert_int_eq(tvi_state_save(it, NULL, &size), TVI_OK);
    void *buffer = malloc(size);
    ck_assert_int_eq(tvi_state_save(it, buffer, &size), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&other, r->system, &r->options), TVI_OK);
    ck_assert_int_eq(tvi_state_load(other, buffer, size), TVI_OK);
    free(buffer);
    tvi_integrator_free(it);
    return other;
}

/* At most so many steps, or to the end of a run to a tolerance. */
static tvi_status call(const random_run *r, tvi_integrator *it, long steps, point *x, notes *to)
{
    const tvi_event *const *events = (const tvi_event *const *)r->events;
    to->steps = 0;
    to->by_observer = false;
    if (r->kind == BY_STEPS)
        return tvi_integrate_events(it, r->h, steps, events, r->count, &x->t, x->q, x->p, count_step, take_note, to);
    return tvi_integrate_tolerance_events(it, r->tolerance, r->t0 + (double)r->steps * r->h, events, r->count, &x->t,
                                          x->q, x->p, count_step, take_note, to);
}

static void go_alone(const random_run *r, uint64_t *bits, notes *to)
{
    enum { MOST_CALLS = 2000 };
    tvi_integrator *it;
    point x = start_of_member(r, 0);
    long left = r->steps;
    ck_assert_int_eq(tvi_integrator_create(&it, r->system, &r->options), TVI_OK);
    for (int calls = 0; calls < MOST_CALLS && left > 0; calls++) {
        const long piece = bits ? 1 + (long)(number_of(bits) * (double)left / 3) : left;
        to->stop_after = bits && number_of(bits) < 0.5 ? 1 + whole(bits, 5) : 0;
        to->status = call(r, it, piece, &x, to);
        if (r->kind == BY_STEPS) left -= to->steps;
        else if (to->status == TVI_OK) left = 0;
        const bool is_stop = to->status == TVI_ESTOPPED && !to->by_observer;
        if (to->status != TVI_OK && to->status != TVI_ESTOPPED) break;
        for (int i = 0; is_stop && r->turns && i < r->of->scene->n; i++) x.p[i] = -x.p[i];
        if (is_stop) left--; /* so that a run of many stops ends */
        if (bits && number_of(bits) < 0.3) it = move_on(r, it);
    }
    if (to->by_observer) to->status = TVI_OK; /* it was the last step */
    to->end[0] = x;
    tvi_integrator_free(it);
}

/* ---- Members ----------------------------------------------------------------------------------------------------- */

static tvi_ensemble *move_members_on(const random_run *r, tvi_ensemble *e)
{
    size_t size = 0;
    tvi_ensemble *other;
    ck_assert_int_eq(tvi_ensemble_save(e, NULL, &size), TVI_OK);
    void *buffer = malloc(size);
    ck_assert_int_eq(tvi_ensemble_save(e, buffer, &size), TVI_OK);
    ck_assert_int_eq(tvi_ensemble_create(&other, r->system, &r->options, r->members, 1), TVI_OK);
    ck_assert_int_eq(tvi_ensemble_load(other, buffer, size), TVI_OK);
    free(buffer);
    tvi_ensemble_free(e);
    return other;
}

static void go_together(const random_run *r, uint64_t *bits, notes *to)
{
    const int n = r->of->scene->n;
    double t[MOST_MEMBERS], q[MOST_N * MOST_MEMBERS], p[MOST_N * MOST_MEMBERS];
    tvi_status each[MOST_MEMBERS];
    tvi_ensemble *e;
    for (int m = 0; m < r->members; m++) {
        const point x = start_of_member(r, m);
        t[m] = x.t;
        for (int i = 0; i < n; i++) q[i * r->members + m] = x.q[i], p[i * r->members + m] = x.p[i];
    }
    ck_assert_int_eq(tvi_ensemble_create(&e, r->system, &r->options, r->members, 1), TVI_OK);
    for (long left = r->steps, piece; left > 0; left -= piece) {
        piece = bits ? 1 + (long)(number_of(bits) * (double)left / 3) : left;
        const tvi_ensemble_plan plan = {.h = r->h,
                                        .steps = piece,
                                        .events = (const tvi_event *const *)r->events,
                                        .event_count = r->count,
                                        .on_event = take_member_note,
                                        .ctx = to};
        to->status = tvi_ensemble_run(e, &plan, t, q, p, each);
        if (to->status != TVI_OK) break;
        if (bits && number_of(bits) < 0.3) e = move_members_on(r, e);
    }
    for (int m = 0; m < r->members; m++) {
        to->end[m] = (point){.t = t[m]};
        for (int i = 0; i < n; i++) to->end[m].q[i] = q[i * r->members + m], to->end[m].p[i] = p[i * r->members + m];
        if (each[m] != TVI_OK) to->status = each[m];
    }
    tvi_ensemble_free(e);
}

/* Of a member after the other: within one, in order of time. */
static int by_member(const void *a, const void *b)
{
    return ((const event_note *)a)->member - ((const event_note *)b)->member;
}

static void sort_by_member(notes *to)
{
    for (int i = 1; i < to->count; i++) /* keeps the order of equal ones */
        for (int j = i; j > 0 && by_member(&to->note[j - 1], &to->note[j]) > 0; j--) {
            const event_note later = to->note[j - 1];
            to->note[j - 1] = to->note[j];
            to->note[j] = later;
        }
}

void make_notes(const random_run *r, uint64_t *bits, notes *to)
{
    memset(to, 0, sizeof *to);
    to->n = r->of->scene->n;
    if (r->kind == OF_MEMBERS) go_together(r, bits, to);
    else go_alone(r, bits, to);
    sort_by_member(to);
}
