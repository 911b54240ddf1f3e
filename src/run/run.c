/* run.c - Runs an integrator step by step and calls the observers (run.h). The file also defines tvi_step_tangent,
 * tvi_taylor_order, and the functions tvi_integrate... with the exception of tvi_integrate_at (times.c). */
#include "run/run.h"
#include "run/times.h"
#include "system/refuse.h"

#include <float.h>
#include <limits.h>
#include <math.h>

/* [steps] A run checks once in this many steps that its time moves. */
#define RUN_STEPS_BETWEEN_CHECKS 64 /* found: make check-events */
/* [steps] A run fails after this many consecutive steps that hardly move its time. */
#define RUN_MAX_SLOW_STEPS (1 << 16) /* found: make check-rescaled */

int tvi_call_observer(tvi_integrator *it, tvi_observer *observer, long step, double t, const double q[],
                      const double p[], void *ctx)
{
    if (!observer) return 0;
    __attribute__((cleanup(tvi_end_observer_call))) tvi_integrator *called = it;
    called->is_in_observer = true;
    return observer(step, t, q, p, ctx);
}

void tvi_end_observer_call(tvi_integrator **it) { (*it)->is_in_observer = false; }

/* ---- Steps to a time --------------------------------------------------------------------------------------------- */

/* The sequence of steps of a run, which depends on its mode. */
typedef struct tvi_schedule tvi_schedule;
struct tvi_schedule {
    /* Makes the next step or steps, and sets *is_end_of_run to true if the run ends with them. */
    tvi_status (*step)(tvi_integrator *it, const tvi_schedule *schedule, double *t, double q[], double p[],
                       bool *is_end_of_run);
    const tvi_run_plan *plan;
    /* The largest number of calls of `step` in the run, and the largest number of steps that one call may make. */
    long most_calls, most_steps_per_call;
    bool loads_user_state;    /* true if the user's state is loaded into the integrator before the first step */
    bool continues_last_step; /* true if the first of the given times lie in the step that was made before the run */
    bool ends_at_t_end;       /* true if the run ends at t_end */
    double t_end;
};

/* Returns the remaining time t_end - t, with the low-order part of the time t. */
static double remaining_time_to(const tvi_integrator *it, double t_end)
{
    const int n = it->system->n;
    return (t_end - it->state.q[n]) - it->state.q_low[n];
}

/* Refuses to go on (TVI_ENOCONV) with a run whose time hardly moves: after RUN_MAX_SLOW_STEPS consecutive steps that
 * each covered less than a 2^53rd of the remaining time. *slow_step_count is the number of such steps since the last
 * faster step. */
static tvi_status check_time_advances(const tvi_integrator *it, double t_end, int *slow_step_count)
{
    const double left = remaining_time_to(it, t_end);
    *slow_step_count = fabs(it->covered_time) < DBL_EPSILON / 2 * fabs(left) ? *slow_step_count + 1 : 0;
    return *slow_step_count < RUN_MAX_SLOW_STEPS
               ? TVI_OK
               : jet_refuse(TVI_ENOCONV, "the time hardly moves: by %g in a step, with %g left", it->covered_time,
                            left);
}

/* Replaces a step of a rescaled system that went past t_end by a shorter step from the same start that ends at
 * t_end. */
static tvi_status shorten_step_to_end_time(tvi_integrator *it, double t_end, double *t, double q[], double p[])
{
    tvi_partial_step partial_step;
    const tvi_status opened = tvi_partial_step_open(&partial_step, it, false);
    tvi_status status = opened == TVI_OK ? tvi_partial_step_to_time(&partial_step, t_end) : opened;
    tvi_integrator_undo_step(it, t, q, p);
    if (status == TVI_OK && partial_step.stored_state_offset != 0)
        status = tvi_step(it, partial_step.stored_state_offset, t, q, p);
    if (opened == TVI_OK) tvi_partial_step_close(&partial_step);
    return status;
}

/* Sets the time to t_end, from which it differs by roundoff alone. The difference is kept in the low-order part of the
 * time. */
static void set_time_to_t_end(tvi_integrator *it, double t_end, double *t)
{
    const int n = it->system->n;
    it->state.q_low[n] += it->state.q[n] - t_end;
    it->state.q[n] = *t = t_end;
}

/* Returns how many steps of size h can be made in one call. If the steps are steps in time (not in s), the last steps
 * are excluded, since roundoff decides whether one more fits before t_end. */
static long count_steps_for_one_stepper_call(const tvi_integrator *it, const tvi_schedule *schedule,
                                             double remaining_time)
{
    const double whole = tvi_is_rescaled(it) ? INFINITY : floor(fabs(remaining_time / schedule->plan->h)) - 1;
    return whole < 1 ? 1 : (long)fmin(whole, (double)schedule->most_steps_per_call);
}

/* Makes one or more steps of size h, or the last step of the run. If the steps are steps in time, the last one has the
 * size of the remaining time. */
static tvi_status make_steps_towards_end_time(tvi_integrator *it, const tvi_schedule *schedule, double *t, double q[],
                                              double p[], bool *is_end_of_run)
{
    const double h = schedule->plan->h, t_end = schedule->t_end, remaining_time = remaining_time_to(it, t_end);
    const double roundoff = 2 * DBL_EPSILON * fmax(fabs(t_end), fabs(*t));
    const bool ends = !tvi_is_rescaled(it) && fabs(remaining_time) <= fabs(h) + roundoff;
    const double before_end = t_end - copysign(roundoff, h);
    tvi_status status = ends ? tvi_step(it, remaining_time, t, q, p)
                             : tvi_make_steps(it, count_steps_for_one_stepper_call(it, schedule, remaining_time), 0, h,
                                              before_end, t, q, p);
    const double left = ends ? 0 : remaining_time_to(it, t_end);
    *is_end_of_run = fabs(left) <= roundoff || (left > 0) != (h > 0);
    if (status == TVI_OK && fabs(left) > roundoff && *is_end_of_run)
        status = shorten_step_to_end_time(it, t_end, t, q, p);
    if (status == TVI_OK && *is_end_of_run) set_time_to_t_end(it, t_end, t);
    return status;
}

/* Makes one step whose size keeps the local error within the tolerance, no farther than t_end and no larger than the
 * plan's largest_step. A step that ends within roundoff of t_end ends at t_end, so that no tiny step must follow. */
static tvi_status make_step_by_tolerance(tvi_integrator *it, const tvi_schedule *schedule, double *t, double q[],
                                         double p[], bool *is_end_of_run)
{
    const double rest = remaining_time_to(it, schedule->t_end), largest = schedule->plan->largest_step;
    const double roundoff = 2 * DBL_EPSILON * fmax(fabs(schedule->t_end), fabs(*t));
    const bool is_limited = largest > 0 && fabs(rest) > largest + roundoff;
    const double farthest = is_limited ? copysign(largest, rest) : rest;
    const tvi_status status =
        tvi_make_steps(it, 1, schedule->plan->tolerance, farthest, tvi_infinite_end_time(farthest), t, q, p);
    *is_end_of_run = status == TVI_OK && (it->h == rest || *t == schedule->t_end);
    if (*is_end_of_run) set_time_to_t_end(it, schedule->t_end, t);
    return status;
}

/* ---- The course of a run ----------------------------------------------------------------------------------------- */

/* Makes steps of size h in a run that ends after a number of steps, or after the last of the given times. */
static tvi_status make_steps_without_end_time(tvi_integrator *it, const tvi_schedule *schedule, double *t, double q[],
                                              double p[], bool *is_end_of_run)
{
    (void)is_end_of_run;
    return tvi_make_steps(it, schedule->most_steps_per_call, 0, schedule->plan->h,
                          tvi_infinite_end_time(schedule->plan->h), t, q, p);
}

/* Tells whether the steps must be made one by one, since an observer, an event or the tangent vectors need each of
 * them. */
static bool needs_single_steps(const tvi_single_run *run)
{
    return run->plan->event_count > 0 || run->observers.at_step || run->columns.elements;
}

static tvi_status set_schedule_for_step_count(const tvi_single_run *run, tvi_schedule *schedule)
{
    const long steps = run->plan->steps, steps_per_call = needs_single_steps(run) || steps == 0 ? 1 : steps;
    if (steps < 0) return jet_refuse(TVI_EINVAL, "steps is negative");
    *schedule = (tvi_schedule){.step = make_steps_without_end_time,
                               .plan = run->plan,
                               .most_calls = steps / steps_per_call,
                               .most_steps_per_call = steps_per_call};
    return TVI_OK;
}

static tvi_status set_schedule_for_end_time(const tvi_integrator *it, const tvi_single_run *run, double t,
                                            tvi_schedule *schedule)
{
    const tvi_run_plan *plan = run->plan;
    const bool by_tolerance = run->mode == TVI_RUN_TO_TOLERANCE;
    if (!isfinite(plan->t_end)) return jet_refuse(TVI_EINVAL, "t_end is not finite");
    if (!by_tolerance && (plan->h > 0 ? plan->t_end < t : plan->t_end > t))
        return jet_refuse(TVI_EINVAL, "h = %g does not go from t = %g to t_end = %g", plan->h, t, plan->t_end);
    *schedule = (tvi_schedule){.step = by_tolerance ? make_step_by_tolerance : make_steps_towards_end_time,
                               .plan = plan,
                               .most_calls = t == plan->t_end ? 0 : LONG_MAX,
                               .most_steps_per_call =
                                   needs_single_steps(run) || !it->stats.is_compiled ? 1 : RUN_STEPS_BETWEEN_CHECKS,
                               .loads_user_state = true,
                               .ends_at_t_end = true,
                               .t_end = plan->t_end};
    return by_tolerance ? tvi_check_tolerance(it, plan->tolerance) : TVI_OK;
}

static tvi_status set_schedule_for_times(const tvi_integrator *it, const tvi_single_run *run, double t,
                                         const double q[], const double p[], tvi_schedule *schedule)
{
    const int count = run->plan->time_count;
    const tvi_status status = tvi_times_check(it, run, t, q, p, &schedule->continues_last_step);
    if (status != TVI_OK) return status;
    schedule->step = make_steps_without_end_time;
    schedule->plan = run->plan;
    schedule->most_calls = count > 0 ? LONG_MAX : 0;
    schedule->most_steps_per_call = 1;
    schedule->ends_at_t_end = true;
    schedule->t_end = count > 0 ? run->plan->times[count - 1] : t;
    return TVI_OK;
}

tvi_status tvi_check_tolerance(const tvi_integrator *it, double tolerance)
{
    if (!(tolerance >= DBL_EPSILON && tolerance < 1))
        return jet_refuse(TVI_EINVAL, "tolerance is below DBL_EPSILON or not below 1");
    return it->stepper->step_within_tolerance && !tvi_is_rescaled(it)
               ? TVI_OK
               : jet_refuse(TVI_EUNSUPPORTED, "a tolerance is for \"taylor\" and systems that are not rescaled");
}

int tvi_taylor_order(double tolerance)
{
    if (!(tolerance >= DBL_EPSILON && tolerance < 1)) return 0;
    return (int)fmax(2, ceil(1 - log(tolerance) / 2));
}

/* Checks those arguments that the run's mode needs, and sets the schedule of its steps. */
static tvi_status set_run_schedule(const tvi_integrator *it, const tvi_single_run *run, double t, const double q[],
                                   const double p[], tvi_schedule *schedule)
{
    const double h = run->plan->h;
    if (!tvi_events_match_dimension(it, run->plan->events, run->plan->event_count)) return TVI_EINVAL;
    if (run->mode == TVI_RUN_TO_TOLERANCE) return set_schedule_for_end_time(it, run, t, schedule);
    if (h == 0 || !isfinite(h)) return tvi_refuse_invalid_run_arguments((tvi_run_arguments){it, &t, q, p, h}, "");
    if (run->mode == TVI_RUN_TO_TIME) return set_schedule_for_end_time(it, run, t, schedule);
    if (run->mode == TVI_RUN_AT_TIMES) return set_schedule_for_times(it, run, t, q, p, schedule);
    return set_schedule_for_step_count(run, schedule);
}

/* ---- The steps of a run ------------------------------------------------------------------------------------------ */

/* A run whose arguments have been checked: its integrator, its plan, and the objects that report its given times and
 * its events. */
typedef struct {
    tvi_integrator *integrator;
    const tvi_single_run *run;
    tvi_schedule schedule;
    tvi_times_progress *times; /* NULL if the run has no given times */
    tvi_locator *locator;      /* NULL if the run has no events */
} run_in_progress;

/* Makes the next step, and multiplies the tangent vectors by its Jacobian matrix. If the multiplication fails, the step
 * is undone. */
static tvi_status make_next_step(const run_in_progress *in_progress, double *t, double q[], double p[],
                                 bool *is_end_of_run)
{
    const long before = in_progress->integrator->stats.steps;
    tvi_status status =
        in_progress->schedule.step(in_progress->integrator, &in_progress->schedule, t, q, p, is_end_of_run);
    if (status != TVI_OK || in_progress->integrator->stats.steps == before) return status;
    status = tvi_columns_propagate_by_step(in_progress->integrator, &in_progress->run->columns);
    if (status != TVI_OK) tvi_integrator_undo_step(in_progress->integrator, t, q, p);
    return status;
}

/* Reports the given times and the events that lie in the step just made, and then the step itself. */
static tvi_status report_times_events_and_step(const run_in_progress *in_progress, long step, double *t, double q[],
                                               double p[])
{
    const tvi_observers *observers = &in_progress->run->observers;
    tvi_status status =
        in_progress->times ? tvi_partial_step_set_parameters(&in_progress->times->partial_step) : TVI_OK;
    if (status == TVI_OK && in_progress->locator)
        status = tvi_locator_report_events(in_progress->locator, in_progress->times, t, q, p);
    if (status == TVI_OK && in_progress->times) status = tvi_times_report_until(in_progress->times, *t);
    if (status != TVI_OK) return status;
    const bool stops =
        tvi_call_observer(in_progress->integrator, observers->at_step,
                          in_progress->run->step_count_before_segment + step, *t, q, p, observers->ctx) != 0;
    return stops || (in_progress->times && in_progress->times->is_stopped_by_observer) ? TVI_ESTOPPED : TVI_OK;
}

/* Frees what the run has opened, also where an exception leaves an observer. */
static void close_locator(tvi_locator **locator) { tvi_locator_close(*locator); }
static void close_times(tvi_times_progress *times) { tvi_times_close(times); }

/* An observer that has reset the integrator could step it. */
static tvi_status refuse_steps_of_observer(const tvi_integrator *it, long steps, tvi_status status)
{
    if (it->stats.steps == steps || (status != TVI_OK && status != TVI_ESTOPPED)) return status;
    return jet_refuse(TVI_EINVAL, "an observer has reset the integrator and stepped it, which ends its run");
}

static tvi_status make_all_steps(run_in_progress *in_progress, double *t, double q[], double p[])
{
    const double *const state[] = {q, p};
    const bool has_events = in_progress->run->plan->event_count > 0;
    const tvi_integrator *it = in_progress->integrator;
    __attribute__((cleanup(close_locator))) tvi_locator *locator = NULL;
    tvi_status status =
        has_events ? tvi_locator_open(&locator, in_progress->integrator, in_progress->run, *t, state) : TVI_OK;
    in_progress->locator = locator;
    bool is_end_of_run = false;
    int slow_step_count = 0;
    for (long step = 1; step <= in_progress->schedule.most_calls && !is_end_of_run && status == TVI_OK; step++) {
        status = make_next_step(in_progress, t, q, p, &is_end_of_run);
        const long made = it->stats.steps;
        if (status == TVI_OK) status = report_times_events_and_step(in_progress, step, t, q, p);
        status = refuse_steps_of_observer(it, made, status);
        is_end_of_run = is_end_of_run || (in_progress->times && tvi_times_are_all_reported(in_progress->times));
        if (status == TVI_OK && in_progress->schedule.ends_at_t_end && !is_end_of_run)
            status = check_time_advances(it, in_progress->schedule.t_end, &slow_step_count);
    }
    return status;
}

static tvi_status run_with_given_times(run_in_progress *in_progress, double *t, double q[], double p[])
{
    __attribute__((cleanup(close_times))) tvi_times_progress times = {.integrator = NULL};
    tvi_status status = tvi_times_open(&times, in_progress->integrator, in_progress->run,
                                       in_progress->schedule.continues_last_step, *t, q, p);
    in_progress->times = &times;
    if (status == TVI_OK && !tvi_times_are_all_reported(&times)) status = make_all_steps(in_progress, t, q, p);
    return status;
}

tvi_status tvi_run_integrator(tvi_integrator *it, const tvi_single_run *run, double *t, double q[], double p[])
{
    if (!it || !t || !q || !p) return tvi_refuse_invalid_run_arguments((tvi_run_arguments){it, t, q, p, 1}, "");
    run_in_progress in_progress = {.integrator = it, .run = run};
    tvi_status status = set_run_schedule(it, run, *t, q, p, &in_progress.schedule);
    if (status == TVI_OK && run->columns.elements) status = tvi_integrator_allocate_tangents(it, run->columns.count);
    if (status == TVI_OK && run->columns.elements) status = tvi_columns_check_finite(it, &run->columns);
    if (status == TVI_OK && (in_progress.schedule.loads_user_state || it->is_in_observer))
        status = tvi_integrator_begin_step(it, *t, q, p);
    if (status != TVI_OK) return status;
    tvi_columns_store_run_start(it, &run->columns);
    return run->mode == TVI_RUN_AT_TIMES ? run_with_given_times(&in_progress, t, q, p)
                                         : make_all_steps(&in_progress, t, q, p);
}

tvi_status tvi_integrate_events(tvi_integrator *it, double h, long steps, const tvi_event *const events[], int count,
                                double *t, double q[], double p[], tvi_observer *observer, tvi_event_observer *on_event,
                                void *ctx)
{
    const tvi_run_plan plan = {.h = h, .steps = steps, .events = events, .event_count = count};
    const tvi_observers observers = {.at_step = observer, .on_event = on_event, .ctx = ctx};
    return tvi_run_integrator(it, &(tvi_single_run){.mode = TVI_RUN_STEPS, .plan = &plan, .observers = observers}, t, q,
                              p);
}

tvi_status tvi_integrate(tvi_integrator *it, double h, long steps, double *t, double q[], double p[],
                         tvi_observer *observer, void *ctx)
{
    return tvi_integrate_events(it, h, steps, NULL, 0, t, q, p, observer, NULL, ctx);
}

tvi_status tvi_integrate_to(tvi_integrator *it, double h, double t_end, double *t, double q[], double p[],
                            tvi_observer *observer, void *ctx)
{
    const tvi_run_plan plan = {.h = h, .t_end = t_end};
    const tvi_observers observers = {.at_step = observer, .ctx = ctx};
    return tvi_run_integrator(it, &(tvi_single_run){.mode = TVI_RUN_TO_TIME, .plan = &plan, .observers = observers}, t,
                              q, p);
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

/* Makes a run of one step whose tangent vectors are the columns of D. */
tvi_status tvi_step_tangent(tvi_integrator *it, double h, double *t, double q[], double p[], double D[], int columns)
{
    const tvi_run_arguments given = {it, t, q, p, h};
    const tvi_run_plan plan = {.h = h, .steps = 1};
    if (!it) return tvi_refuse_invalid_run_arguments(given, "");
    if (!it->is_in_observer) it->has_dense_output = false;
    if (!t || !q || !p || !D || columns < 1 || h == 0 || !isfinite(h))
        return tvi_refuse_invalid_run_arguments(given, D ? "columns is not positive" : "D is NULL");
    const tvi_single_run run = {.mode = TVI_RUN_STEPS, .plan = &plan, .columns = {D, columns, 1}};
    return tvi_run_integrator(it, &run, t, q, p);
}
