/* integrate_tolerance.c - Makes runs that end at a given time, with steps whose sizes are chosen to keep the local
 * error within a tolerance (tvi_integrate_tolerance). The Taylor method alone has such steps. */
#include "run/run.h"
#include "system/refuse.h"

#include <float.h>
#include <limits.h>
#include <math.h>

tvi_status tvi_check_tolerance(const tvi_integrator *it, double tolerance)
{
    if (!(tolerance >= DBL_EPSILON && tolerance < 1))
        return jet_refuse(TVI_EINVAL, "tolerance is below DBL_EPSILON or not below 1");
    return it->stepper->step_within && !tvi_is_rescaled(it)
               ? TVI_OK
               : jet_refuse(TVI_EUNSUPPORTED, "a tolerance is for \"taylor\" and systems that are not rescaled");
}

int tvi_taylor_order(double tolerance)
{
    if (!(tolerance >= DBL_EPSILON && tolerance < 1)) return 0;
    return (int)fmax(2, ceil(1 - log(tolerance) / 2));
}

/* Makes one step whose size keeps the local error within the tolerance, no farther than t_end and no larger than the
 * plan's largest_step. A step that ends within roundoff of t_end ends at t_end, so that no tiny step must follow. */
static tvi_status make_step_by_tolerance(tvi_integrator *it, const tvi_schedule *schedule, double *t, double q[],
                                         double p[], bool *is_last)
{
    const double rest = tvi_remaining_time(it, schedule->t_end), largest = schedule->plan->largest_step;
    const double roundoff = 2 * DBL_EPSILON * fmax(fabs(schedule->t_end), fabs(*t));
    const bool is_limited = largest > 0 && fabs(rest) > largest + roundoff;
    const double farthest = is_limited ? copysign(largest, rest) : rest;
    const tvi_status status = tvi_step_by_tolerance(it, schedule->plan->tolerance, farthest, t, q, p);
    *is_last = status == TVI_OK && (it->h == rest || *t == schedule->t_end);
    if (*is_last) tvi_set_time_to_t_end(it, schedule->t_end, t);
    return status;
}

tvi_status tvi_schedule_to_tolerance(const tvi_integrator *it, const tvi_run_plan *plan, double t,
                                     tvi_schedule *schedule)
{
    if (!isfinite(plan->t_end)) return jet_refuse(TVI_EINVAL, "t_end is not finite");
    *schedule = (tvi_schedule){.step = make_step_by_tolerance,
                               .plan = plan,
                               .steps = t == plan->t_end ? 0 : LONG_MAX,
                               .begins = true,
                               .is_to_time = true,
                               .t_end = plan->t_end};
    return tvi_check_tolerance(it, plan->tolerance);
}

tvi_status tvi_integrate_tolerance_events(tvi_integrator *it, double tolerance, double t_end,
                                          const tvi_event *const events[], int count, double *t, double q[], double p[],
                                          tvi_observer *observer, tvi_event_observer *on_event, void *ctx)
{
    const tvi_run_plan plan = {.tolerance = tolerance, .t_end = t_end, .events = events, .event_count = count};
    const tvi_observers observers = {.at_step = observer, .on_event = on_event, .ctx = ctx};
    return tvi_run_integrator(
        it, &(tvi_single_run){.mode = TVI_RUN_TO_TOLERANCE, .plan = &plan, .observers = observers}, t, q, p);
}

tvi_status tvi_integrate_tolerance(tvi_integrator *it, double tolerance, double t_end, double *t, double q[],
                                   double p[], tvi_observer *observer, void *ctx)
{
    return tvi_integrate_tolerance_events(it, tolerance, t_end, NULL, 0, t, q, p, observer, NULL, ctx);
}
