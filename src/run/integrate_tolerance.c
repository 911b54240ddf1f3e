/* integrate_tolerance.c - a run whose steps have the sizes that serve a tolerance. */
#include "run/locate.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>

/* A relative tolerance that double precision can serve. */
static bool is_tolerance(double tolerance) { return tolerance >= DBL_EPSILON && tolerance < 1; }

/* A step to t_end at most. */
static tvi_status step_towards(tvi_integrator *it, double tolerance, double t_end, double *t, double q[], double p[],
                               bool *is_last)
{
    const double rest = tvi_time_left(it, t_end);
    const tvi_status status = tvi_step_within(it, tolerance, rest, t, q, p);
    *is_last = status == TVI_OK && (it->h == rest || *t == t_end);
    if (*is_last) tvi_end_at(it, t_end, t);
    return status;
}

tvi_status tvi_integrate_tolerance_events(tvi_integrator *it, double tolerance, double t_end,
                                          const tvi_event *const events[], int count, double *t, double q[], double p[],
                                          tvi_observer *observer, tvi_event_observer *on_event, void *ctx)
{
    if (!it || !t || !q || !p || !is_tolerance(tolerance) || !isfinite(t_end))
        return tvi_refuse_run((tvi_run_arguments){it, t, q, p, 1},
                              is_tolerance(tolerance) ? "t_end is not finite"
                                                      : "tolerance is below DBL_EPSILON or not below 1");
    if (!tvi_events_fit(it, events, count)) return TVI_EINVAL;
    if (!it->stepper->step_within || tvi_is_rescaled(it))
        return jet_refuse(TVI_EUNSUPPORTED, "a tolerance is for \"taylor\" and systems that are not rescaled");
    tvi_locator *locator = NULL;
    tvi_status status = tvi_integrator_begin(it, *t, q, p);
    if (status == TVI_OK && count > 0) status = tvi_locator_open(&locator, it, events, count);
    bool is_last = *t == t_end;
    for (long step = 1; !is_last && status == TVI_OK; step++) {
        status = step_towards(it, tolerance, t_end, t, q, p, &is_last);
        if (status == TVI_OK && locator) status = tvi_locator_tell(locator, t, q, p, on_event, ctx);
        if (status == TVI_OK && observer && observer(step, *t, q, p, ctx) != 0) status = TVI_ESTOPPED;
    }
    tvi_locator_close(locator);
    return status;
}

tvi_status tvi_integrate_tolerance(tvi_integrator *it, double tolerance, double t_end, double *t, double q[],
                                   double p[], tvi_observer *observer, void *ctx)
{
    return tvi_integrate_tolerance_events(it, tolerance, t_end, NULL, 0, t, q, p, observer, NULL, ctx);
}
