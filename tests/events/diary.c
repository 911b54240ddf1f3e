/* diary.c - Implements diary.h. */
#include "diary.h"

#include <check.h>
#include <string.h>

static int note_step(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)t, (void)q, (void)p;
    ((diary *)ctx)->steps = step;
    return 0;
}

int note_event(int which, double t, const double q[], const double p[], void *ctx)
{
    diary *d = ctx;
    ck_assert_int_lt(d->count, MOST_TOLD);
    point *x = &d->at[d->count];
    *x = (point){.t = t};
    memcpy(x->q, q, (size_t)d->n * sizeof *q);
    memcpy(x->p, p, (size_t)d->n * sizeof *p);
    d->last_step[d->count] = d->steps;
    d->which[d->count++] = which;
    return d->count == d->stop_at;
}

tvi_event *event_of(int n, tvi_direction direction, bool terminal, tvi_event_fn *g, void *ctx)
{
    tvi_event *event = NULL;
    ck_assert_int_eq(tvi_event_create(&event, n, direction, terminal, g, ctx), TVI_OK);
    return event;
}

tvi_status watch(run *r, double h, long steps, tvi_event *events[], int count, diary *d)
{
    d->n = tvi_system_dimension(r->system);
    const tvi_status status = tvi_integrate_events(r->integrator, h, steps, (const tvi_event *const *)events, count,
                                                   &r->x.t, r->x.q, r->x.p, note_step, note_event, d);
    for (int i = 0; i < count; i++) tvi_event_free(events[i]);
    return status;
}
