/* plan.c - Refuses plans of runs (tvi_run_plan) that contradict themselves, and has the functions that run by a plan of
 * their own: tvi_integrate... and tvi_step_tangent. run.c makes the steps of the run. */
#include "run/run.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>

/* ---- Plans with contradictions ----------------------------------------------------------------------------------- */

/* Returns a message if the step size, the number of steps, the times and the tolerance of the plan do not define one
 * mode of a run; if an observer, the events, the times or the tangent vectors of the plan need a field that the plan
 * does not set; or if the plan's mode does not allow one of these. Returns NULL if the plan has no contradiction. */
static const char *find_contradiction(const tvi_run_plan *plan)
{
    const bool by_tolerance = plan->tolerance != 0, to_times = plan->time_count != 0, in_steps = plan->steps != 0;
    if (plan->size != 0 && plan->size != sizeof *plan) return "size is not that of a tvi_run_plan of this version";
    if (plan->steps < 0) return "steps is negative";
    if (plan->time_count < 0 || plan->columns < 0) return "a count is negative";
    if (to_times && !plan->times) return "times is NULL";
    if (by_tolerance && plan->h != 0) return "h and tolerance are both given";
    if (!by_tolerance && plan->h == 0) return "h is 0";
    if (in_steps && by_tolerance) return "steps and tolerance are both given: a tolerance goes to t_end";
    if (to_times && by_tolerance) return "times and tolerance are both given: a tolerance goes to t_end alone";
    if (in_steps && to_times) return "steps and time_count are both given";
    if (in_steps && plan->has_t_end) return "steps and has_t_end are both given";
    if (!isfinite(plan->t_end)) return "t_end is not finite";
    if (plan->t_end != 0 && !plan->has_t_end && !by_tolerance) return "t_end is given without has_t_end";
    if (!by_tolerance && plan->largest_step != 0) return "largest_step is given without tolerance";
    if (!(plan->largest_step >= 0 && isfinite(plan->largest_step))) return "largest_step is negative or not finite";
    if (plan->columns > 0 && !plan->D) return "columns is given, and D is NULL";
    if (plan->D && plan->columns == 0) return "D is given, and columns is 0";
    if (plan->columns_at_once && !plan->D) return "columns_at_once is given without D";
    if (plan->times && plan->time_count == 0) return "times is given, and time_count is 0";
    if (plan->at_time && plan->time_count == 0) return "at_time is given, and time_count is 0";
    if (plan->on_event && plan->event_count == 0) return "on_event is given, and event_count is 0";
    if (plan->event_count > 0 && !plan->events) return "event_count is given, and events is NULL";
    if (plan->observer && (by_tolerance || to_times || plan->has_t_end))
        return "observer is given with times or t_end: it goes with steps alone";
    return NULL;
}

/* Refuses a tolerance that is not positive, or that double precision cannot reach, and any tolerance if the
 * integrator's method cannot choose its steps by one. */
static tvi_status check_tolerance(const tvi_integrator *it, double tolerance)
{
    if (!(tolerance >= DBL_EPSILON && tolerance < 1))
        return jet_refuse(TVI_EINVAL, "tolerance is below DBL_EPSILON or not below 1");
    return it->stepper->step_within_tolerance && !tvi_is_rescaled(it)
               ? TVI_OK
               : jet_refuse(TVI_EUNSUPPORTED, "a tolerance is for \"taylor\" and systems that are not rescaled");
}

tvi_status tvi_plan_check(const tvi_integrator *it, const tvi_run_plan *plan)
{
    const char *reason = plan ? find_contradiction(plan) : "plan is NULL";
    if (reason) return jet_refuse(TVI_EINVAL, "%s", reason);
    if (!isfinite(plan->h)) return jet_refuse(TVI_EINVAL, "h = %g is not finite", plan->h);
    if (!tvi_events_match_dimension(it->system->n, plan->events, plan->event_count)) return TVI_EINVAL;
    if (plan->record && plan->tolerance != 0)
        return jet_refuse(TVI_EUNSUPPORTED, "a record is for runs in steps of size h, not to a tolerance");
    return plan->tolerance != 0 ? check_tolerance(it, plan->tolerance) : TVI_OK;
}

/* ---- Runs without a plan of the user ----------------------------------------------------------------------------- */

int tvi_taylor_order(double tolerance)
{
    if (!(tolerance >= DBL_EPSILON && tolerance < 1)) return 0;
    return (int)fmax(2, ceil(1 - log(tolerance) / 2));
}

tvi_status tvi_integrate_events(tvi_integrator *it, double h, long steps, const tvi_event *const events[], int count,
                                double *t, double q[], double p[], tvi_observer *observer, tvi_event_observer *on_event,
                                void *ctx)
{
    const tvi_run_plan plan = {.h = h, .steps = steps, .events = events, .event_count = count};
    return tvi_run_observed(it, &plan, (tvi_observers){.at_step = observer, .on_event = on_event, .ctx = ctx}, t, q, p);
}

tvi_status tvi_integrate(tvi_integrator *it, double h, long steps, double *t, double q[], double p[],
                         tvi_observer *observer, void *ctx)
{
    return tvi_integrate_events(it, h, steps, NULL, 0, t, q, p, observer, NULL, ctx);
}

tvi_status tvi_integrate_to(tvi_integrator *it, double h, double t_end, double *t, double q[], double p[],
                            tvi_observer *observer, void *ctx)
{
    const tvi_run_plan plan = {.h = h, .t_end = t_end, .has_t_end = true};
    return tvi_run_observed(it, &plan, (tvi_observers){.at_step = observer, .ctx = ctx}, t, q, p);
}

tvi_status tvi_integrate_at(tvi_integrator *it, double h, const double times[], int count, double *t, double q[],
                            double p[], tvi_observer *observer, void *ctx)
{
    const tvi_run_plan plan = {.h = h, .times = count == 0 ? NULL : times, .time_count = count};
    return tvi_run_observed(it, &plan, (tvi_observers){.at_time = observer, .ctx = ctx}, t, q, p);
}

tvi_status tvi_integrate_tolerance_events(tvi_integrator *it, double tolerance, double t_end,
                                          const tvi_event *const events[], int count, double *t, double q[], double p[],
                                          tvi_observer *observer, tvi_event_observer *on_event, void *ctx)
{
    const tvi_run_plan plan = {.tolerance = tolerance != 0 ? tolerance : -1, /* for 0 there is no plan: -1 is refused */
                               .t_end = t_end,
                               .has_t_end = true,
                               .events = events,
                               .event_count = count};
    return tvi_run_observed(it, &plan, (tvi_observers){.at_step = observer, .on_event = on_event, .ctx = ctx}, t, q, p);
}

tvi_status tvi_integrate_tolerance(tvi_integrator *it, double tolerance, double t_end, double *t, double q[],
                                   double p[], tvi_observer *observer, void *ctx)
{
    return tvi_integrate_tolerance_events(it, tolerance, t_end, NULL, 0, t, q, p, observer, NULL, ctx);
}

tvi_status tvi_step_tangent(tvi_integrator *it, double h, double *t, double q[], double p[], double D[], int columns)
{
    const tvi_run_arguments given = {it, t, q, p, h};
    const tvi_run_plan plan = {.h = h, .steps = 1, .columns = columns, .D = D};
    if (!it) return tvi_refuse_invalid_run_arguments(given, "");
    if (!it->is_in_observer) it->last_step.has_curve = false;
    if (!t || !q || !p || !D || columns < 1 || h == 0 || !isfinite(h))
        return tvi_refuse_invalid_run_arguments(given, D ? "columns is not positive" : "D is NULL");
    return tvi_run_observed(it, &plan, (tvi_observers){0}, t, q, p);
}
