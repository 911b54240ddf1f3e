/* run.c - Runs an integrator step by step and calls the observers (run.h). It also defines tvi_integrate and
 * tvi_integrate_events, which make steps of one size. */
#include "run/run.h"
#include "run/times.h"
#include "system/refuse.h"

#include <limits.h>
#include <math.h>

int tvi_call_observer(tvi_integrator *it, tvi_observer *observer, long step, double t, const double q[],
                      const double p[], void *ctx)
{
    if (!observer) return 0;
    it->is_in_observer = true;
    const int stop = observer(step, t, q, p, ctx);
    it->is_in_observer = false;
    return stop;
}

int tvi_call_event_observer(tvi_integrator *it, tvi_event_observer *observer, int event_index, double t,
                            const double q[], const double p[], void *ctx)
{
    if (!observer) return 0;
    it->is_in_observer = true;
    const int stop = observer(event_index, t, q, p, ctx);
    it->is_in_observer = false;
    return stop;
}

/* ---- The course of a run ----------------------------------------------------------------------------------------- */

static tvi_status make_scheduled_steps(tvi_integrator *it, const tvi_schedule *schedule, double *t, double q[],
                                       double p[], bool *is_last)
{
    (void)is_last;
    return tvi_make_steps(it, schedule->at_once, schedule->plan->h, tvi_infinite_end_time(schedule->plan->h), t, q, p);
}

/* Tells whether the steps must be made one by one, since an observer, an event or the tangent vectors need each of
 * them. */
static bool is_each_step_observed(const tvi_single_run *run)
{
    return run->plan->event_count > 0 || run->observers.at_step || run->columns.elements;
}

static tvi_status set_schedule_for_step_count(const tvi_single_run *run, tvi_schedule *schedule)
{
    const long steps = run->plan->steps, at_once = is_each_step_observed(run) || steps == 0 ? 1 : steps;
    if (steps < 0) return jet_refuse(TVI_EINVAL, "steps is negative");
    *schedule =
        (tvi_schedule){.step = make_scheduled_steps, .plan = run->plan, .steps = steps / at_once, .at_once = at_once};
    return TVI_OK;
}

static tvi_status set_schedule_for_times(const tvi_integrator *it, const tvi_single_run *run, double t,
                                         const double q[], const double p[], tvi_schedule *schedule)
{
    const int count = run->plan->time_count;
    const tvi_status status = tvi_times_check(it, run, t, q, p, &schedule->continues_last_step);
    if (status != TVI_OK) return status;
    schedule->step = make_scheduled_steps;
    schedule->plan = run->plan;
    schedule->steps = count > 0 ? LONG_MAX : 0;
    schedule->at_once = 1;
    schedule->is_to_time = true;
    schedule->t_end = count > 0 ? run->plan->times[count - 1] : t;
    return TVI_OK;
}

/* Checks those arguments that the run's mode needs, and sets the schedule of its steps. */
static tvi_status set_schedule_for_mode(const tvi_integrator *it, const tvi_single_run *run, double t, const double q[],
                                        const double p[], tvi_schedule *schedule)
{
    const double h = run->plan->h;
    if (!tvi_events_match_system(it, run->plan->events, run->plan->event_count)) return TVI_EINVAL;
    if (run->mode == TVI_RUN_TO_TOLERANCE) return tvi_schedule_to_tolerance(it, run->plan, t, schedule);
    if (h == 0 || !isfinite(h)) return tvi_refuse_run_arguments((tvi_run_arguments){it, &t, q, p, h}, "");
    if (run->mode == TVI_RUN_TO_TIME)
        return tvi_schedule_to_time(it, run->plan, t, is_each_step_observed(run), schedule);
    if (run->mode == TVI_RUN_AT_TIMES) return set_schedule_for_times(it, run, t, q, p, schedule);
    return set_schedule_for_step_count(run, schedule);
}

/* ---- Its steps --------------------------------------------------------------------------------------------------- */

/* A run whose arguments have been checked: its integrator, its plan, and the objects that report its given times and
 * its events. */
typedef struct {
    tvi_integrator *integrator;
    const tvi_single_run *run;
    tvi_schedule schedule;
    tvi_times_progress *times; /* NULL if the run has no given times */
    tvi_locator *locator;      /* NULL if the run has no events */
} run_in_progress;

/* Makes the next step, and multiplies the tangent vectors by its Jacobian matrix. If that fails, the step is undone. */
static tvi_status make_next_step(const run_in_progress *in_progress, double *t, double q[], double p[], bool *is_last)
{
    const long before = in_progress->integrator->stats.steps;
    tvi_status status = in_progress->schedule.step(in_progress->integrator, &in_progress->schedule, t, q, p, is_last);
    if (status != TVI_OK || in_progress->integrator->stats.steps == before) return status;
    status = tvi_columns_propagate_by_last_step(in_progress->integrator, &in_progress->run->columns);
    if (status != TVI_OK) tvi_integrator_undo_step(in_progress->integrator, t, q, p);
    return status;
}

/* Reports the given times and the events that lie in the step just made, and then the step itself. */
static tvi_status report_times_events_and_step(const run_in_progress *in_progress, long step, double *t, double q[],
                                               double p[])
{
    const tvi_observers *observers = &in_progress->run->observers;
    tvi_status status = in_progress->times ? tvi_times_update_parameters(in_progress->times) : TVI_OK;
    if (status == TVI_OK && in_progress->locator)
        status = tvi_locator_report_events(in_progress->locator, in_progress->times, t, q, p);
    if (status == TVI_OK && in_progress->times) status = tvi_times_report_until(in_progress->times, *t);
    if (status != TVI_OK) return status;
    const bool stops = tvi_call_observer(in_progress->integrator, observers->at_step,
                                         in_progress->run->steps_before_segment + step, *t, q, p, observers->ctx) != 0;
    return stops || (in_progress->times && in_progress->times->is_stopped_by_observer) ? TVI_ESTOPPED : TVI_OK;
}

static tvi_status make_all_steps(run_in_progress *in_progress, double *t, double q[], double p[])
{
    const double *const state[] = {q, p};
    const bool has_events = in_progress->run->plan->event_count > 0;
    tvi_status status =
        has_events ? tvi_locator_open(&in_progress->locator, in_progress->integrator, in_progress->run, *t, state)
                   : TVI_OK;
    bool is_last = false;
    int slow_step_count = 0;
    for (long step = 1; step <= in_progress->schedule.steps && !is_last && status == TVI_OK; step++) {
        status = make_next_step(in_progress, t, q, p, &is_last);
        if (status == TVI_OK) status = report_times_events_and_step(in_progress, step, t, q, p);
        is_last = is_last || (in_progress->times && tvi_times_are_all_reported(in_progress->times));
        if (status == TVI_OK && in_progress->schedule.is_to_time && !is_last)
            status =
                tvi_run_check_time_advances(in_progress->integrator, in_progress->schedule.t_end, &slow_step_count);
    }
    tvi_locator_close(in_progress->locator);
    return status;
}

static tvi_status run_with_given_times(run_in_progress *in_progress, double *t, double q[], double p[])
{
    tvi_times_progress times;
    tvi_status status = tvi_times_open(&times, in_progress->integrator, in_progress->run,
                                       in_progress->schedule.continues_last_step, *t, q, p);
    in_progress->times = &times;
    if (status == TVI_OK && !tvi_times_are_all_reported(&times)) status = make_all_steps(in_progress, t, q, p);
    tvi_times_close(&times);
    return status;
}

tvi_status tvi_run_integrator(tvi_integrator *it, const tvi_single_run *run, double *t, double q[], double p[])
{
    if (!it || !t || !q || !p) return tvi_refuse_run_arguments((tvi_run_arguments){it, t, q, p, 1}, "");
    run_in_progress in_progress = {.integrator = it, .run = run};
    tvi_status status = set_schedule_for_mode(it, run, *t, q, p, &in_progress.schedule);
    if (status == TVI_OK && run->columns.elements) status = tvi_columns_check_finite(it, &run->columns);
    if (status == TVI_OK && run->columns.elements) status = tvi_integrator_allocate_tangents(it, run->columns.count);
    if (status == TVI_OK && (in_progress.schedule.begins || it->is_in_observer))
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
