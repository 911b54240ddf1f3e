/* plans.c - Implements plans.h. */
#include "plans.h"
#include "integrator/integrator.h"

#include <math.h>
#include <string.h>

static int take(plan_diary *d, told_kind kind, int member, int which, double t, const double q[], const double p[])
{
    ck_assert_int_lt(d->count, MOST_SEEN);
    ck_assert_int_eq(member, 0);
    told *s = &d->told[d->count++];
    *s = (told){.kind = kind, .which = which, .x = {.t = t}, .h = d->it->last_step.h};
    memcpy(s->x.q, q, (size_t)d->n * sizeof *q);
    memcpy(s->x.p, p, (size_t)d->n * sizeof *p);
    memcpy(s->D, d->D, (size_t)d->numbers * sizeof *d->D);
    for (int k = 0; d->scrawls && kind != STEP && k < d->numbers; k++) d->D[k] = NAN;
    d->of_kind[kind]++;
    return kind == d->stops && d->of_kind[kind] == d->stop_at;
}

int see_step(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    return take(ctx, STEP, member, which, t, q, p);
}

int see_time(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    const plan_diary *d = ctx;
    ck_assert_int_eq(which, d->of_kind[TIME] - d->times_before + 1);
    return take(ctx, TIME, member, d->times_before + which, t, q, p);
}

int see_event(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    return take(ctx, EVENT, member, which, t, q, p);
}

const told *next_told(const plan_diary *d, told_kind kind, int i)
{
    do i++;
    while (i < d->count && d->told[i].kind != kind);
    return i < d->count ? &d->told[i] : NULL;
}

const told *last_told(const plan_diary *d, told_kind kind)
{
    int i = d->count - 1;
    while (i >= 0 && d->told[i].kind != kind) i--;
    return i >= 0 ? &d->told[i] : NULL;
}

static jet place(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t;
    return jet_sub(q[0], *(const double *)ctx);
}

static jet momentum(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)t;
    return jet_sub(p[0], *(const double *)ctx);
}

static tvi_event *event_of(int n, bool is_terminal, tvi_event_fn *g, const double *level)
{
    tvi_event *event;
    ck_assert_int_eq(tvi_event_create(&event, n, TVI_EITHER, is_terminal, g, (void *)level), TVI_OK);
    return event;
}

tvi_event *event_at_place(int n, bool is_terminal, const double *level)
{
    return event_of(n, is_terminal, place, level);
}

tvi_event *event_at_momentum(int n, bool is_terminal, const double *level)
{
    return event_of(n, is_terminal, momentum, level);
}

jet wider_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_add(1, jet_mul(0.1, jet_sqr(q[0])));
}

bool open_pairing(run *r, const pairing *pair, bool is_rescaled, tvi_system **base)
{
    *r = run_open(pair->scene, pair->method, pair->order);
    *base = r->system;
    if (!is_rescaled) return true;
    const tvi_options options = *tvi_integrator_options(r->integrator);
    tvi_integrator_free(r->integrator);
    r->integrator = NULL;
    if (tvi_system_rescaled(&r->system, *base, wider_scale, NULL) != TVI_OK) r->system = *base;
    return r->system != *base && tvi_integrator_create(&r->integrator, r->system, &options) == TVI_OK;
}

void close_pairing(run *r, tvi_system *base)
{
    tvi_integrator_free(r->integrator);
    if (r->system != base) tvi_system_free(r->system);
    tvi_system_free(base);
}

void start_diary(plan_diary *d, const run *r, int columns)
{
    memset(d, 0, sizeof *d);
    d->it = r->integrator;
    d->n = tvi_system_dimension(r->system);
    d->numbers = 2 * d->n * columns;
    for (int k = 0; k < d->numbers; k++) d->D[k] = 1.0 / (1 + k % 5) - (k % 3);
}

/* The plan with these, too. */
tvi_status run_with(run *r, tvi_run_plan plan, int with, tvi_event *const events[2], plan_diary *d)
{
    plan.ctx = d;
    if (with & WITH_EVENTS) {
        plan.events = (const tvi_event *const *)events;
        plan.event_count = 2;
        plan.on_event = see_event;
    }
    if (with & WITH_D) plan.D = d->D, plan.columns = COLUMNS;
    if (with & WITH_STEPS) plan.at_step = see_step;
    return tvi_run(r->integrator, &plan, &r->x.t, r->x.q, r->x.p);
}

static bool are_same(const told *a, const told *b, bool has_columns)
{
    if (!a || !b) return a == b;
    return a->which == b->which && same_point(&a->x, &b->x) && (!has_columns || memcmp(a->D, b->D, sizeof a->D) == 0);
}

/* All of one kind in both are the same, and as many. */
void expect_same_told(const plan_diary *a, const plan_diary *b, told_kind kind, bool has_columns)
{
    const told *x = next_told(a, kind, -1), *y = next_told(b, kind, -1);
    while (x && are_same(x, y, has_columns)) {
        x = next_told(a, kind, (int)(x - a->told));
        y = next_told(b, kind, (int)(y - b->told));
    }
    ck_assert_msg(!x && !y, "kind %d differs", (int)kind);
}
