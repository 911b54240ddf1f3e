/* integrate_tolerance.c - a run whose steps have the sizes that serve a tolerance. */
#include "run/run.h"
#include "system/refuse.h"

#include <float.h>
#include <limits.h>
#include <math.h>

tvi_status tvi_serves_tolerance(const tvi_integrator *it, double tolerance)
{
    if (!(tolerance >= DBL_EPSILON && tolerance < 1))
        return jet_refuse(TVI_EINVAL, "tolerance is below DBL_EPSILON or not below 1");
    return it->stepper->step_within && !tvi_is_rescaled(it)
               ? TVI_OK
               : jet_refuse(TVI_EUNSUPPORTED, "a tolerance is for \"taylor\" and systems that are not rescaled");
}

/* A step to t_end at most. */
static tvi_status step_within(tvi_integrator *it, const tvi_plan *plan, double *t, double q[], double p[],
                              bool *is_last)
{
    const double rest = tvi_time_left(it, plan->t_end);
    const tvi_status status = tvi_step_within(it, plan->tolerance, rest, t, q, p);
    *is_last = status == TVI_OK && (it->h == rest || *t == plan->t_end);
    if (*is_last) tvi_end_at(it, plan->t_end, t);
    return status;
}

tvi_status tvi_integrate_tolerance_events(tvi_integrator *it, double tolerance, double t_end,
                                          const tvi_event *const events[], int count, double *t, double q[], double p[],
                                          tvi_observer *observer, tvi_event_observer *on_event, void *ctx)
{
    if (!it || !t || !q || !p || !isfinite(t_end))
        return tvi_refuse_run((tvi_run_arguments){it, t, q, p, 1}, "t_end is not finite");
    if (!tvi_events_fit(it, events, count)) return TVI_EINVAL;
    const tvi_status served = tvi_serves_tolerance(it, tolerance);
    if (served != TVI_OK) return served;
    const long steps = *t == t_end ? 0 : LONG_MAX;
    const tvi_plan plan = {
        .step = step_within, .steps = steps, .tolerance = tolerance, .t_end = t_end, .to_time = true};
    const tvi_status status = tvi_integrator_begin(it, *t, q, p);
    if (status != TVI_OK) return status;
    return tvi_run(it, &plan, &(tvi_audience){events, count, on_event, observer, ctx}, t, q, p);
}

tvi_status tvi_integrate_tolerance(tvi_integrator *it, double tolerance, double t_end, double *t, double q[],
                                   double p[], tvi_observer *observer, void *ctx)
{
    return tvi_integrate_tolerance_events(it, tolerance, t_end, NULL, 0, t, q, p, observer, NULL, ctx);
}
