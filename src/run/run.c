/* run.c - Runs an integrator by a schedule, calls the observers, and defines the public runs of steps of one size. */
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

int tvi_call_event_observer(tvi_integrator *it, tvi_event_observer *observer, int which, double t, const double q[],
                            const double p[], void *ctx)
{
    if (!observer) return 0;
    it->is_in_observer = true;
    const int stop = observer(which, t, q, p, ctx);
    it->is_in_observer = false;
    return stop;
}

/* ---- The course of a run ----------------------------------------------------------------------------------------- */

static tvi_status make_steps(tvi_integrator *it, const tvi_schedule *schedule, double *t, double q[], double p[],
                             bool *is_last)
{
    (void)is_last;
    return tvi_steps(it, schedule->at_once, schedule->plan->h, tvi_endless(schedule->plan->h), t, q, p);
}

/* Tells whether an observer or the columns need each step. */
static bool is_observed(const tvi_single_run *run)
{
    return run->plan->event_count > 0 || run->observers.at_step || run->columns.elements;
}

static tvi_status schedule_in_steps(const tvi_single_run *run, tvi_schedule *schedule)
{
    const long steps = run->plan->steps, at_once = is_observed(run) || steps == 0 ? 1 : steps;
    if (steps < 0) return jet_refuse(TVI_EINVAL, "steps is negative");
    *schedule = (tvi_schedule){.step = make_steps, .plan = run->plan, .steps = steps / at_once, .at_once = at_once};
    return TVI_OK;
}

static tvi_status schedule_at_times(const tvi_integrator *it, const tvi_single_run *run, double t, const double q[],
                                    const double p[], tvi_schedule *schedule)
{
    const int count = run->plan->time_count;
    const tvi_status status = tvi_times_check(it, run, t, q, p, &schedule->has_step);
    if (status != TVI_OK) return status;
    schedule->step = make_steps;
    schedule->plan = run->plan;
    schedule->steps = count > 0 ? LONG_MAX : 0;
    schedule->at_once = 1;
    schedule->is_to_time = true;
    schedule->t_end = count > 0 ? run->plan->times[count - 1] : t;
    return TVI_OK;
}

/* Checks the arguments of the run's mode, and sets the schedule. */
static tvi_status set_schedule(const tvi_integrator *it, const tvi_single_run *run, double t, const double q[],
                               const double p[], tvi_schedule *schedule)
{
    const double h = run->plan->h;
    if (!tvi_events_match_system(it, run->plan->events, run->plan->event_count)) return TVI_EINVAL;
    if (run->mode == TVI_RUN_TO_TOLERANCE) return tvi_schedule_to_tolerance(it, run->plan, t, schedule);
    if (h == 0 || !isfinite(h)) return tvi_refuse_run((tvi_run_arguments){it, &t, q, p, h}, "");
    if (run->mode == TVI_RUN_TO_TIME) return tvi_schedule_to_time(it, run->plan, t, is_observed(run), schedule);
    if (run->mode == TVI_RUN_AT_TIMES) return schedule_at_times(it, run, t, q, p, schedule);
    return schedule_in_steps(run, schedule);
}

/* ---- Its steps --------------------------------------------------------------------------------------------------- */

/* A run that has begun. */
typedef struct {
    tvi_integrator *it;
    const tvi_single_run *run;
    tvi_schedule schedule;
    tvi_times *times;     /* NULL: no times */
    tvi_locator *locator; /* NULL: no events */
} running;

/* Makes the next step, and moves the columns by it. */
static tvi_status make_step(const running *r, double *t, double q[], double p[], bool *is_last)
{
    const long before = r->it->stats.steps;
    tvi_status status = r->schedule.step(r->it, &r->schedule, t, q, p, is_last);
    if (status != TVI_OK || r->it->stats.steps == before) return status;
    status = tvi_columns_move_by_last_step(r->it, &r->run->columns);
    if (status != TVI_OK) tvi_integrator_undo(r->it, t, q, p);
    return status;
}

/* Reports the times and the events of the step that was just made, and then the step. */
static tvi_status report_step(const running *r, long step, double *t, double q[], double p[])
{
    const tvi_observers *observers = &r->run->observers;
    tvi_status status = r->times ? tvi_times_update_parameters(r->times) : TVI_OK;
    if (status == TVI_OK && r->locator) status = tvi_locator_report_events(r->locator, r->times, t, q, p);
    if (status == TVI_OK && r->times) status = tvi_times_report_until(r->times, *t);
    if (status != TVI_OK) return status;
    const bool stops = tvi_call_observer(r->it, observers->at_step, r->run->steps_before_segment + step, *t, q, p,
                                         observers->ctx) != 0;
    return stops || (r->times && r->times->is_stopped_by_observer) ? TVI_ESTOPPED : TVI_OK;
}

static tvi_status make_steps_of(running *r, double *t, double q[], double p[])
{
    const double *const state[] = {q, p};
    const bool has_events = r->run->plan->event_count > 0;
    tvi_status status = has_events ? tvi_locator_open(&r->locator, r->it, r->run, *t, state) : TVI_OK;
    bool is_last = false;
    int slow = 0;
    for (long step = 1; step <= r->schedule.steps && !is_last && status == TVI_OK; step++) {
        status = make_step(r, t, q, p, &is_last);
        if (status == TVI_OK) status = report_step(r, step, t, q, p);
        is_last = is_last || (r->times && tvi_times_are_reported(r->times));
        if (status == TVI_OK && r->schedule.is_to_time && !is_last)
            status = tvi_run_check_progress(r->it, r->schedule.t_end, &slow);
    }
    tvi_locator_close(r->locator);
    return status;
}

static tvi_status run_at_times(running *r, double *t, double q[], double p[])
{
    tvi_times times;
    tvi_status status = tvi_times_open(&times, r->it, r->run, r->schedule.has_step, *t, q, p);
    r->times = &times;
    if (status == TVI_OK && !tvi_times_are_reported(&times)) status = make_steps_of(r, t, q, p);
    tvi_times_close(&times);
    return status;
}

tvi_status tvi_run_one(tvi_integrator *it, const tvi_single_run *run, double *t, double q[], double p[])
{
    if (!it || !t || !q || !p) return tvi_refuse_run((tvi_run_arguments){it, t, q, p, 1}, "");
    running r = {.it = it, .run = run};
    tvi_status status = set_schedule(it, run, *t, q, p, &r.schedule);
    if (status == TVI_OK && run->columns.elements) status = tvi_columns_check_finite(it, &run->columns);
    if (status == TVI_OK && run->columns.elements) status = tvi_integrator_allocate_tangent(it, run->columns.count);
    if (status == TVI_OK && (r.schedule.begins || it->is_in_observer)) status = tvi_integrator_begin(it, *t, q, p);
    if (status != TVI_OK) return status;
    tvi_columns_begin_run(it, &run->columns);
    return run->mode == TVI_RUN_AT_TIMES ? run_at_times(&r, t, q, p) : make_steps_of(&r, t, q, p);
}

tvi_status tvi_integrate_events(tvi_integrator *it, double h, long steps, const tvi_event *const events[], int count,
                                double *t, double q[], double p[], tvi_observer *observer, tvi_event_observer *on_event,
                                void *ctx)
{
    const tvi_run_plan plan = {.h = h, .steps = steps, .events = events, .event_count = count};
    const tvi_observers observers = {.at_step = observer, .on_event = on_event, .ctx = ctx};
    return tvi_run_one(it, &(tvi_single_run){.mode = TVI_RUN_STEPS, .plan = &plan, .observers = observers}, t, q, p);
}

tvi_status tvi_integrate(tvi_integrator *it, double h, long steps, double *t, double q[], double p[],
                         tvi_observer *observer, void *ctx)
{
    return tvi_integrate_events(it, h, steps, NULL, 0, t, q, p, observer, NULL, ctx);
}
