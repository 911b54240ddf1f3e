/* cuts.c - Implements cuts.h. */
#include "cuts.h"
#include "problems/random.h"
#include "problems/texts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static jet wider(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_add(1, jet_mul(0.1, jet_sqr(q[0])));
}

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

bool make_run(random_run *r, uint64_t *bits, bool wants_touching, bool wants_terminal)
{
    return make_run_of(r, &pairings[whole(bits, PAIRINGS)], bits, wants_touching, wants_terminal);
}

/* In order, some of them equal, and some about the ends of steps. */
static void make_times(random_run *r, uint64_t *bits)
{
    double part = 0;
    r->time_count = 1 + whole(bits, MOST_RESULTS);
    for (int i = 0; i < r->time_count; i++) {
        if (number_of(bits) < 0.8) part += 2 * number_of(bits) * (double)r->steps / r->time_count;
        if (number_of(bits) < 0.2) part = ceil(part);
        r->times[i] = r->t0 + part * r->h;
    }
}

static void make_size(random_run *r, uint64_t *bits)
{
    const double starts[] = {0, 0, 2.4e6, 1.7e9};
    r->is_rescaled = number_of(bits) < 0.3;
    r->turns = number_of(bits) < 0.3;
    r->tolerance = pow(10, -6 - 8 * number_of(bits));
    r->h = r->pair->h * (0.2 + number_of(bits)) * (number_of(bits) < 0.5 ? -1 : 1);
    r->t0 = number_of(bits) < 0.2 ? 100 * number_of(bits) : starts[whole(bits, 4)];
    r->steps = 1 + whole(bits, 80);
    r->t_end = r->t0 + (double)r->steps * r->h;
    if (r->kind == TO_TIME && number_of(bits) < 0.7) r->t_end -= number_of(bits) * r->h;
    r->largest_step = number_of(bits) < 0.3 ? 2 * fabs(r->h) * number_of(bits) : 0;
    if (r->kind == AT_TIMES) make_times(r, bits);
}

bool make_run_of(random_run *r, const pairing *pair, uint64_t *bits, bool wants_touching, bool wants_terminal)
{
    *r = (random_run){.pair = pair, .kind = (run_kind)whole(bits, RUN_KINDS)};
    const double so_many = number_of(bits), vectors = number_of(bits);
    make_size(r, bits);
    r->count = number_of(bits) < 0.9 ? 1 + whole(bits, MOST_EVENTS) : 0;
    r->members = so_many < 0.6 ? 0 : so_many < 0.8 ? 1 : MOST_MEMBERS;
    r->columns = vectors < 0.7 ? 0 : vectors < 0.85 ? 1 : MOST_COLUMNS;
    ck_assert_int_eq(tvi_options_named(r->pair->method, r->pair->order, &r->options), TVI_OK);
    ck_assert_int_eq(scene_system(r->pair->scene, &r->base), TVI_OK);
    const bool may_stop = r->members == 0 || r->kind == BY_TOLERANCE || r->kind == TO_TIME;
    for (int i = 0; i < r->count; i++) make_random_event(r, i, bits, wants_touching, wants_terminal && may_stop);
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
    const scene *s = r->pair->scene;
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
    for (int k = 0; k < 2 * to->n * to->columns; k++) next->D[k] = to->D[k * to->members + member];
    return which < MOST_EVENTS && to->by_event;
}

static int note_event(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    return note(ctx, member, which, t, q, p);
}

static int note_time(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    notes *to = ctx;
    (void)note(to, member, MOST_EVENTS + to->times_told + which - 1, t, q, p);
    if (which != to->stop_at_time) return 0;
    to->by_observer = true;
    return 1;
}

static int count_step(int member, int step, double t, const double q[], const double p[], void *ctx)
{
    notes *to = ctx;
    (void)member, (void)t, (void)q, (void)p;
    to->steps = step;
    const bool stops = step == to->stop_after;
    to->by_observer |= stops;
    return stops;
}

/* The same for the functions without a plan. */
static int note_event_alone(int which, double t, const double q[], const double p[], void *ctx)
{
    return note(ctx, 0, which, t, q, p);
}

static int note_time_alone(long which, double t, const double q[], const double p[], void *ctx)
{
    return note_time(0, (int)which, t, q, p, ctx);
}

static int count_step_alone(long step, double t, const double q[], const double p[], void *ctx)
{
    return count_step(0, (int)step, t, q, p, ctx);
}

void start_notes(const random_run *r, notes *to)
{
    memset(to, 0, sizeof *to);
    to->n = r->pair->scene->n;
    to->columns = r->columns;
    to->members = r->members > 0 ? r->members : 1;
    for (int k = 0; k < 2 * to->n * r->columns * to->members; k++) to->D[k] = 1.0 / (1 + k / to->members % 7);
}

tvi_run_plan plan_of(const random_run *r, notes *to)
{
    tvi_run_plan plan = {.events = (const tvi_event *const *)r->events, .event_count = r->count, .ctx = to};
    if (r->count > 0) plan.on_event = note_event;
    if (r->columns > 0) plan.D = to->D, plan.columns = r->columns;
    if (r->kind == BY_TOLERANCE) plan.tolerance = r->tolerance, plan.largest_step = r->largest_step;
    else plan.h = r->h;
    if (r->kind == BY_STEPS) plan.steps = r->steps;
    else if (r->kind == AT_TIMES) plan.times = r->times, plan.time_count = r->time_count, plan.at_time = note_time;
    else plan.t_end = r->t_end, plan.has_t_end = true;
    return plan;
}

/* ---- One integrator ---------------------------------------------------------------------------------------------- */

/* The integrator becomes another one, with its state. */
static tvi_integrator *move_on(const random_run *r, tvi_integrator *it, point *x)
{
    tvi_integrator *other;
    char *text = text_of_state(it, x->t, x->q, x->p);
    ck_assert_int_eq(tvi_integrator_create(&other, r->system, &r->options), TVI_OK);
    ck_assert_int_eq(tvi_state_from_text(other, text, strlen(text), &x->t, x->q, x->p), TVI_OK);
    free(text);
    tvi_integrator_free(it);
    return other;
}

/* By the function that the plan's run has without it, if there is one. */
static tvi_status call_function(const random_run *r, tvi_integrator *it, const tvi_run_plan *plan, point *x, notes *to)
{
    const bool has_events = plan->event_count > 0;
    if (r->columns == 0 && r->kind == BY_STEPS)
        return tvi_integrate_events(it, plan->h, plan->steps, plan->events, plan->event_count, &x->t, x->q, x->p,
                                    count_step_alone, note_event_alone, to);
    if (r->columns == 0 && r->kind == BY_TOLERANCE && plan->largest_step == 0)
        return tvi_integrate_tolerance_events(it, plan->tolerance, plan->t_end, plan->events, plan->event_count, &x->t,
                                              x->q, x->p, count_step_alone, note_event_alone, to);
    if (r->columns == 0 && r->kind == TO_TIME && !has_events)
        return tvi_integrate_to(it, plan->h, plan->t_end, &x->t, x->q, x->p, NULL, NULL);
    if (r->columns == 0 && r->kind == AT_TIMES && !has_events)
        return tvi_integrate_at(it, plan->h, plan->times, plan->time_count, &x->t, x->q, x->p, note_time_alone, to);
    return tvi_run(it, plan, &x->t, x->q, x->p);
}

/* A part of what is left of the run: some steps, some times, or up to where an observer stops it; all without bits. */
static tvi_status call(const random_run *r, tvi_integrator *it, uint64_t *bits, long left, point *x, notes *to)
{
    tvi_run_plan plan = plan_of(r, to);
    const int told = to->times_told, rest = r->time_count - told, noted = to->count;
    to->steps = to->stop_after = to->stop_at_time = 0;
    to->by_observer = false;
    if (bits && number_of(bits) < 0.5) to->stop_after = 1 + whole(bits, 5);
    if (bits && rest > 0 && number_of(bits) < 0.3) to->stop_at_time = 1 + whole(bits, rest);
    plan.at_step = count_step;
    if (r->kind == BY_STEPS) plan.steps = bits ? 1 + (long)(number_of(bits) * (double)left / 3) : left;
    if (r->kind == AT_TIMES) plan.times += told, plan.time_count = rest;
    if (r->kind == AT_TIMES && bits && !r->has_terminal && number_of(bits) < 0.5)
        plan.time_count = 1 + whole(bits, rest);
    const tvi_status status = bits ? tvi_run(it, &plan, &x->t, x->q, x->p) : call_function(r, it, &plan, x, to);
    for (int i = noted; i < to->count; i++) to->times_told += to->note[i].which >= MOST_EVENTS;
    return status;
}

static bool is_over(const random_run *r, const point *x, long left, const notes *to)
{
    if (left <= 0) return true;
    if (r->kind == AT_TIMES) return to->times_told == r->time_count;
    return r->kind != BY_STEPS && x->t == r->t_end;
}

/* Whether the state may be loaded by another integrator, which knows no times in the last step. */
static bool may_move(const random_run *r, const point *x, const notes *to)
{
    return r->kind != AT_TIMES || to->times_told == r->time_count ||
           (r->h > 0 ? r->times[to->times_told] >= x->t : r->times[to->times_told] <= x->t);
}

static void go_alone(const random_run *r, uint64_t *bits, notes *to)
{
    enum { MOST_CALLS = 4000 };
    tvi_integrator *it;
    point x = start_of_member(r, 0);
    long left = r->steps;
    int calls = 0;
    ck_assert_int_eq(tvi_integrator_create(&it, r->system, &r->options), TVI_OK);
    for (; calls < MOST_CALLS && !is_over(r, &x, left, to); calls++) {
        to->status = call(r, it, bits, left, &x, to);
        if (r->kind == BY_STEPS) left -= to->steps;
        const bool is_stop = to->status == TVI_ESTOPPED && !to->by_observer;
        if (to->status != TVI_OK && to->status != TVI_ESTOPPED) break;
        for (int i = 0; is_stop && r->turns && i < r->pair->scene->n; i++) x.p[i] = -x.p[i];
        if (is_stop) left--; /* so that a run of many stops ends */
        if (bits && may_move(r, &x, to) && number_of(bits) < 0.3) it = move_on(r, it, &x);
    }
    ck_assert_int_lt(calls, MOST_CALLS);
    if (to->by_observer && to->status == TVI_ESTOPPED) to->status = TVI_OK; /* it was the last step */
    to->end[0] = x;
    tvi_integrator_free(it);
}

/* ---- Members ----------------------------------------------------------------------------------------------------- */

static tvi_ensemble *move_members_on(const random_run *r, tvi_ensemble *e, double t[], double q[], double p[])
{
    tvi_ensemble *other;
    ck_assert_int_eq(tvi_ensemble_create(&other, r->system, &r->options, r->members, 1), TVI_OK);
    move_members(e, other, r->members, t, q, p);
    tvi_ensemble_free(e);
    return other;
}

/* The number of times for the next call: as many as leave the other times outside of the step of the last one; all of
 * them in s. */
static int times_of_piece(const random_run *r, uint64_t *bits, int told)
{
    int count = r->is_rescaled ? r->time_count : told + 1 + whole(bits, r->time_count - told);
    for (; count < r->time_count; count++) {
        const double last = (r->times[count - 1] - r->t0) / r->h, next = (r->times[count] - r->t0) / r->h;
        if (next > ceil(last) + 0.1) break;
    }
    return count - told;
}

/* A part of the run of all members; *left: of steps, or of times, or 1 while some member is not at the end. */
static void call_all(const random_run *r, uint64_t *bits, tvi_ensemble *e, double x[], tvi_status each[], long *left,
                     notes *to)
{
    double *q = x + r->members, *p = q + r->members * to->n;
    tvi_run_plan plan = plan_of(r, to);
    const bool is_to_time = r->kind == TO_TIME || r->kind == BY_TOLERANCE;
    to->stop_after = bits && is_to_time && number_of(bits) < 0.5 ? 1 + whole(bits, 5) : 0;
    if (to->stop_after > 0) plan.at_step = count_step;
    if (r->kind == BY_STEPS) *left -= plan.steps = bits ? 1 + (long)(number_of(bits) * (double)*left / 3) : *left;
    if (r->kind == AT_TIMES) {
        plan.times += to->times_told;
        plan.time_count = bits ? times_of_piece(r, bits, to->times_told) : r->time_count;
    }
    ck_assert_int_eq(tvi_ensemble_run(e, &plan, x, q, p, each), TVI_OK);
    to->times_told += plan.time_count;
    if (r->kind == AT_TIMES) *left = r->time_count - to->times_told;
    if (!is_to_time) return;
    *left = 0;
    for (int m = 0; m < r->members; m++) *left |= each[m] == TVI_ESTOPPED;
}

static void go_together(const random_run *r, uint64_t *bits, notes *to)
{
    enum { MOST_CALLS = 4000 };
    const int n = r->pair->scene->n, members = r->members;
    double x[(1 + 2 * MOST_N) * MOST_MEMBERS], *q = x + members, *p = q + members * n;
    tvi_status each[MOST_MEMBERS];
    tvi_ensemble *e;
    int calls = 0;
    for (int m = 0; m < members; m++) {
        const point start = start_of_member(r, m);
        x[m] = start.t;
        for (int i = 0; i < n; i++) q[i * members + m] = start.q[i], p[i * members + m] = start.p[i];
    }
    ck_assert_int_eq(tvi_ensemble_create(&e, r->system, &r->options, members, 1), TVI_OK);
    for (long left = r->steps; left > 0 && calls < MOST_CALLS; calls++) {
        call_all(r, bits, e, x, each, &left, to);
        if (bits && number_of(bits) < 0.3) e = move_members_on(r, e, x, q, p);
    }
    ck_assert_int_lt(calls, MOST_CALLS);
    for (int m = 0; m < members; m++) {
        to->end[m] = (point){.t = x[m]};
        for (int i = 0; i < n; i++) to->end[m].q[i] = q[i * members + m], to->end[m].p[i] = p[i * members + m];
        if (each[m] != TVI_OK) to->status = each[m];
    }
    tvi_ensemble_free(e);
}

/* Member after member, its events and then its times: within these, in order of time. */
static bool is_before(const event_note *a, const event_note *b)
{
    const bool a_is_time = a->which >= MOST_EVENTS, b_is_time = b->which >= MOST_EVENTS;
    return a->member < b->member || (a->member == b->member && a_is_time < b_is_time);
}

static void sort_notes(notes *to)
{
    for (int i = 1; i < to->count; i++) /* keeps the order of equal ones */
        for (int j = i; j > 0 && is_before(&to->note[j], &to->note[j - 1]); j--) {
            const event_note later = to->note[j - 1];
            to->note[j - 1] = to->note[j];
            to->note[j] = later;
        }
}

void make_notes(const random_run *r, uint64_t *bits, notes *to)
{
    start_notes(r, to);
    if (r->members > 0) go_together(r, bits, to);
    else go_alone(r, bits, to);
    sort_notes(to);
}
