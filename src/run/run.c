/* run.c - see run.h; and the runs of so many steps of one size. */
#include "run/run.h"
#include "system/refuse.h"

#include <math.h>

tvi_status tvi_run(tvi_integrator *it, const tvi_plan *plan, const tvi_audience *to, double *t, double q[], double p[])
{
    tvi_locator *locator = NULL;
    const double *const state[] = {q, p};
    tvi_status status = to->count > 0 ? tvi_locator_open(&locator, it, to->events, to->count, *t, state) : TVI_OK;
    bool is_last = false;
    int slow = 0;
    for (long step = 1; step <= plan->steps && !is_last && status == TVI_OK; step++) {
        status = plan->step(it, plan, t, q, p, &is_last);
        if (status == TVI_OK && locator) status = tvi_locator_tell(locator, t, q, p, to->on_event, to->ctx);
        if (status == TVI_OK && tvi_tell_step(it, to->observer, step, *t, q, p, to->ctx) != 0) status = TVI_ESTOPPED;
        if (status == TVI_OK && plan->to_time && !is_last) status = tvi_goes_on(it, plan->t_end, &slow);
    }
    tvi_locator_close(locator);
    return status;
}

int tvi_tell_step(tvi_integrator *it, tvi_observer *observer, long step, double t, const double q[], const double p[],
                  void *ctx)
{
    if (!observer) return 0;
    it->is_telling = true;
    const int stop = observer(step, t, q, p, ctx);
    it->is_telling = false;
    return stop;
}

int tvi_tell_event(tvi_integrator *it, tvi_event_observer *observer, int which, double t, const double q[],
                   const double p[], void *ctx)
{
    if (!observer) return 0;
    it->is_telling = true;
    const int stop = observer(which, t, q, p, ctx);
    it->is_telling = false;
    return stop;
}

/* What nobody is told of is made at once. */
static tvi_status step_of_size(tvi_integrator *it, const tvi_plan *plan, double *t, double q[], double p[],
                               bool *is_last)
{
    (void)is_last;
    return tvi_steps(it, plan->at_once, plan->h, tvi_no_end(plan->h), t, q, p);
}

tvi_status tvi_integrate_events(tvi_integrator *it, double h, long steps, const tvi_event *const events[], int count,
                                double *t, double q[], double p[], tvi_observer *observer, tvi_event_observer *on_event,
                                void *ctx)
{
    if (!it || !t || !q || !p || h == 0 || !isfinite(h) || steps < 0)
        return tvi_refuse_run((tvi_run_arguments){it, t, q, p, h}, "steps is negative");
    if (!tvi_events_fit(it, events, count)) return TVI_EINVAL;
    const long at_once = count > 0 || observer || steps == 0 ? 1 : steps;
    const tvi_plan plan = {.step = step_of_size, .steps = steps / at_once, .at_once = at_once, .h = h};
    return tvi_run(it, &plan, &(tvi_audience){events, count, on_event, observer, ctx}, t, q, p);
}

tvi_status tvi_integrate(tvi_integrator *it, double h, long steps, double *t, double q[], double p[],
                         tvi_observer *observer, void *ctx)
{
    return tvi_integrate_events(it, h, steps, NULL, 0, t, q, p, observer, NULL, ctx);
}
