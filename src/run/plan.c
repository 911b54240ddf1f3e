/* plan.c - Refuses plans of runs (tvi_run_plan) that contradict themselves, and calls the observers of a plan, those of
 * members of ensembles one at a time (plan.h). run.c makes the steps of the run. */
#include "run/plan.h"
#include "system/refuse.h"

#include <float.h>
#include <limits.h>
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
    return plan->tolerance != 0 ? check_tolerance(it, plan->tolerance) : TVI_OK;
}

/* ---- The observers of a plan ------------------------------------------------------------------------------------- */

/* A call of an observer of a member. has_returned is false if an exception leaves it. */
typedef struct {
    const tvi_member_run *run;
    bool has_returned;
} observer_call;

static void end_observer_call(observer_call *call)
{
    if (!call->has_returned) tvi_parallel_cancel(call->run->team);
    (void)pthread_mutex_unlock(call->run->observer_lock);
}

static int call_locked_observer(const tvi_member_run *member_run, tvi_member_observer *observer, int report_index,
                                double t, const double q[], const double p[])
{
    (void)pthread_mutex_lock(member_run->observer_lock);
    __attribute__((cleanup(end_observer_call))) observer_call call = {member_run, false};
    const int stop = tvi_parallel_is_stopped(member_run->team) ||
                     observer(member_run->member_index, report_index, t, q, p, member_run->plan->ctx) != 0;
    call.has_returned = true;
    return stop;
}

static int call_member_observer(const tvi_member_run *member_run, tvi_member_observer *observer, long report_index,
                                double t, const double q[], const double p[])
{
    const int index = report_index < INT_MAX ? (int)report_index : INT_MAX;
    if (!observer) return 0;
    return member_run->team ? call_locked_observer(member_run, observer, index, t, q, p)
                            : observer(member_run->member_index, index, t, q, p, member_run->plan->ctx);
}

static int call_event_observer(int event_index, double t, const double q[], const double p[], void *ctx)
{
    const tvi_member_run *member_run = ctx;
    return call_member_observer(member_run, member_run->plan->on_event, event_index, t, q, p);
}

static int call_time_observer(long time_number, double t, const double q[], const double p[], void *ctx)
{
    const tvi_member_run *member_run = ctx;
    return call_member_observer(member_run, member_run->plan->at_time, time_number, t, q, p);
}

static int call_step_observers(long step, double t, const double q[], const double p[], void *ctx)
{
    const tvi_member_run *member_run = ctx;
    const int stop = call_member_observer(member_run, member_run->plan->at_step, step, t, q, p);
    const tvi_status status = stop ? TVI_ESTOPPED : TVI_OK;
    return member_run->ensemble_observer &&
                   member_run->ensemble_observer(step, 1, &t, q, p, &status, member_run->plan->ctx) != 0
               ? 1
               : stop;
}

tvi_status tvi_run_member(tvi_integrator *it, const tvi_member_run *member_run, double *t, double q[], double p[])
{
    const tvi_run_plan *plan = member_run->plan;
    const tvi_single_run run = {
        .plan = plan,
        .observers = {.at_step = plan->at_step || member_run->ensemble_observer ? call_step_observers : NULL,
                      .at_time = plan->at_time ? call_time_observer : NULL,
                      .on_event = plan->on_event ? call_event_observer : NULL,
                      .ctx = (void *)member_run},
        .columns = {plan->D ? plan->D + member_run->member_index : NULL, plan->columns,
                    (size_t)member_run->member_count},
        .step_count_before_segment = member_run->step_count_before_segment,
    };
    return tvi_run_integrator(it, &run, t, q, p);
}

tvi_status tvi_run(tvi_integrator *it, const tvi_run_plan *plan, double *t, double q[], double p[])
{
    if (!it || !t || !q || !p) return tvi_refuse_invalid_run_arguments((tvi_run_arguments){it, t, q, p, 1}, "");
    const tvi_status status = tvi_plan_check(it, plan);
    if (status != TVI_OK) return status;
    const tvi_member_run all = {.plan = plan, .member_count = 1, .ensemble_observer = plan->observer};
    return tvi_run_member(it, &all, t, q, p);
}
