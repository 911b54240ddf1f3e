/* integrate_to.c - Makes runs that end at a given time, with steps of size h and a shorter last step
 * (tvi_integrate_to). It also defines what run.h and integrator.h declare for runs to a time. */
#include "run/partial_step.h"
#include "run/run.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <limits.h>
#include <math.h>

/* The largest number of steps that are made before the run checks again whether its time moves. */
enum { AT_ONCE = 64 };

double tvi_remaining_time(const tvi_integrator *it, double t_end)
{
    const int n = it->system->n;
    return (t_end - it->state.q[n]) - it->state.q_low[n];
}

tvi_status tvi_run_check_time_advances(const tvi_integrator *it, double t_end, int *slow_step_count)
{
    const double left = tvi_remaining_time(it, t_end);
    *slow_step_count = fabs(it->covered) < DBL_EPSILON / 2 * fabs(left) ? *slow_step_count + 1 : 0;
    return *slow_step_count < 1 << 16
               ? TVI_OK
               : jet_refuse(TVI_ENOCONV, "the time hardly moves: by %g in a step, with %g left", it->covered, left);
}

/* Replaces a step of a rescaled system that went past t_end by a shorter step from the same start that ends at
 * t_end. */
static tvi_status shorten_step_to_end_time(tvi_integrator *it, double t_end, double *t, double q[], double p[])
{
    tvi_partial_step partial_step;
    const tvi_status opened = tvi_partial_step_open(&partial_step, it, false);
    tvi_status status = opened == TVI_OK ? tvi_partial_step_compute_state_at_time(&partial_step, t_end) : opened;
    tvi_integrator_undo_step(it, t, q, p);
    if (status == TVI_OK && partial_step.offset != 0) status = tvi_step(it, partial_step.offset, t, q, p);
    if (opened == TVI_OK) tvi_partial_step_close(&partial_step);
    return status;
}

void tvi_set_time_to_t_end(tvi_integrator *it, double t_end, double *t)
{
    const int n = it->system->n;
    it->state.q_low[n] += it->state.q[n] - t_end;
    it->state.q[n] = *t = t_end;
}

/* Returns how many steps of size h can be made in one call. If the steps are steps in time (not in s), the last steps
 * are excluded, since roundoff decides whether one more fits before t_end. */
static long count_steps_of_one_call(const tvi_integrator *it, const tvi_schedule *schedule, double remaining_time)
{
    const double whole = tvi_is_rescaled(it) ? INFINITY : floor(fabs(remaining_time / schedule->plan->h)) - 1;
    return whole < 1 ? 1 : (long)fmin(whole, (double)schedule->at_once);
}

/* Makes one or more steps of size h, or the last step of the run. If the steps are steps in time, the last one has the
 * size of the remaining time. */
static tvi_status make_steps_towards_end(tvi_integrator *it, const tvi_schedule *schedule, double *t, double q[],
                                         double p[], bool *is_last)
{
    const double h = schedule->plan->h, t_end = schedule->t_end, remaining_time = tvi_remaining_time(it, t_end);
    const double roundoff = 2 * DBL_EPSILON * fmax(fabs(t_end), fabs(*t));
    const bool ends = !tvi_is_rescaled(it) && fabs(remaining_time) <= fabs(h) + roundoff;
    const double before_end = t_end - copysign(roundoff, h);
    tvi_status status =
        ends ? tvi_step(it, remaining_time, t, q, p)
             : tvi_make_steps(it, count_steps_of_one_call(it, schedule, remaining_time), h, before_end, t, q, p);
    const double left = ends ? 0 : tvi_remaining_time(it, t_end);
    *is_last = fabs(left) <= roundoff || (left > 0) != (h > 0);
    if (status == TVI_OK && fabs(left) > roundoff && *is_last) status = shorten_step_to_end_time(it, t_end, t, q, p);
    if (status == TVI_OK && *is_last) tvi_set_time_to_t_end(it, t_end, t);
    return status;
}

tvi_status tvi_schedule_to_time(const tvi_integrator *it, const tvi_run_plan *plan, double t, bool is_observed,
                                tvi_schedule *schedule)
{
    if (!isfinite(plan->t_end)) return jet_refuse(TVI_EINVAL, "t_end is not finite");
    if (plan->h > 0 ? plan->t_end < t : plan->t_end > t)
        return jet_refuse(TVI_EINVAL, "h = %g does not go from t = %g to t_end = %g", plan->h, t, plan->t_end);
    *schedule = (tvi_schedule){.step = make_steps_towards_end,
                               .plan = plan,
                               .steps = t == plan->t_end ? 0 : LONG_MAX,
                               .at_once = is_observed || !it->stats.is_compiled ? 1 : AT_ONCE,
                               .begins = true,
                               .is_to_time = true,
                               .t_end = plan->t_end};
    return TVI_OK;
}

tvi_status tvi_integrate_to(tvi_integrator *it, double h, double t_end, double *t, double q[], double p[],
                            tvi_observer *observer, void *ctx)
{
    const tvi_run_plan plan = {.h = h, .t_end = t_end};
    const tvi_observers observers = {.at_step = observer, .ctx = ctx};
    return tvi_run_integrator(it, &(tvi_single_run){.mode = TVI_RUN_TO_TIME, .plan = &plan, .observers = observers}, t,
                              q, p);
}
