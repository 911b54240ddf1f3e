/* run.c - Runs an integrator by a plan (tvi_run): makes step after step, and reports what lies in each to the observers
 * (run.h). */
#include "run/end.h"
#include "run/record.h"
#include "run/run.h"
#include "run/times.h"
#include "system/refuse.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <string.h>

/* [steps] A run fails after this many consecutive steps that hardly move its time. */
#define RUN_MAX_SLOW_STEPS (1 << 16) /* found: make check-rescaled */

/* Allows steps again after an observer has returned, or was left by an exception of C++. */
static void end_call(tvi_integrator **it) { (*it)->is_in_observer = false; }

int tvi_call_observer(tvi_integrator *it, tvi_observer *observer, long step, double t, const double q[],
                      const double p[], void *ctx)
{
    if (!observer) return 0;
    __attribute__((cleanup(end_call))) tvi_integrator *called = it;
    called->is_in_observer = true;
    return observer(step, t, q, p, ctx);
}

/* ---- The steps of a run ------------------------------------------------------------------------------------------ */

/* A run whose arguments have been checked: its integrator, its plan, the objects that report its given times and its
 * events, and what it has reached. */
typedef struct {
    tvi_integrator *integrator;
    const tvi_single_run *run;
    const tvi_run_plan *plan;
    tvi_times_progress *times; /* NULL if the run has no given times */
    tvi_event_search *events;  /* NULL if the run has no events */
    long most_steps_per_call;  /* 1 if an observer, an event, a given time or the tangent vectors need each step */
    long step_count;           /* the number of steps that the run has made */
    long slow_step_count;      /* the number of steps since the last one that has moved the time */
    bool is_at_end;            /* true if the run ends with the steps that were made */
    tvi_step_parts parts;      /* the steps that the run makes in the place of a step in s that has failed */
} run_in_progress;

/* Makes the next steps of a run that ends after a number of steps, or after the last of the given times. */
static tvi_status make_steps_of_size_h(run_in_progress *running, double *t, double q[], double p[])
{
    const tvi_run_plan *plan = running->plan;
    const long left = plan->time_count > 0 ? 1 : plan->steps - running->step_count;
    const long steps = left < running->most_steps_per_call ? left : running->most_steps_per_call;
    running->is_at_end = plan->time_count == 0 && steps == left;
    return tvi_make_steps(running->integrator, steps, 0, plan->h, tvi_infinite_end_time(plan->h), t, q, p);
}

/* Ends the run if its last step has reached t_end, from which `left` is left. A step in s that passed t_end is replaced
 * by a shorter one. */
static tvi_status end_if_reached(run_in_progress *running, double left, double roundoff, double *t, double q[],
                                 double p[])
{
    tvi_integrator *it = running->integrator;
    const double t_end = running->plan->t_end;
    running->is_at_end = fabs(left) <= roundoff || (left > 0) != (running->plan->h > 0);
    if (!running->is_at_end) return TVI_OK;
    const tvi_status status = fabs(left) > roundoff ? tvi_shorten_step_to_time(it, t_end, t, q, p) : TVI_OK;
    if (status == TVI_OK) tvi_set_time(it, t_end, t);
    return status;
}

/* Finds parts of the step in s that has failed with this status, which lead to t_end. If there are none, the failure
 * stays. */
static tvi_status find_parts_instead(run_in_progress *running, tvi_status failure)
{
    char text[256];
    bool is_found;
    (void)jet_format(text, sizeof text, "%s", jet_last_refusal_text());
    const tvi_status status =
        tvi_parts_find(&running->parts, running->integrator, running->plan->h, running->plan->t_end, &is_found);
    if (status != TVI_OK) return jet_explain_out_of_memory(status);
    return is_found ? TVI_OK : jet_refuse(failure, "%s", text);
}

/* Makes the next steps of size h of a run to t_end, or its last step. If the steps are steps in time, the last one has
 * the size of the remaining time, but no more than h; if they are steps in s, the one that passes t_end is replaced by
 * a shorter one, and one that fails by parts of it, each of which is a step to an observer. Steps in time that are made
 * in one call end at least one step before t_end. */
static tvi_status make_steps_to_t_end(run_in_progress *running, double *t, double q[], double p[])
{
    tvi_integrator *it = running->integrator;
    const double h = running->plan->h, t_end = running->plan->t_end, remaining = tvi_remaining_time(it, t_end);
    const double roundoff = tvi_time_roundoff(*t, t_end, h), part = tvi_parts_take(&running->parts, h);
    const bool is_rescaled = tvi_is_rescaled(it), is_last = !is_rescaled && fabs(remaining) <= fabs(h) + roundoff;
    const double size = part != 0 ? part : is_last ? copysign(fmin(fabs(h), fabs(remaining)), h) : h;
    const double whole = is_rescaled ? INFINITY : fmax(floor(fabs(remaining / h)) - 1, 1);
    const long steps = part != 0 ? 1 : (long)fmin(whole, (double)running->most_steps_per_call);
    tvi_status status = tvi_make_steps(it, steps, 0, size, t_end - copysign(roundoff, h), t, q, p);
    if (tvi_is_failure_of_member(status) && is_rescaled && part == 0) {
        status = find_parts_instead(running, status);
        return status == TVI_OK ? make_steps_to_t_end(running, t, q, p) : status;
    }
    if (status != TVI_OK) return status;
    return end_if_reached(running, is_last ? 0 : tvi_remaining_time(it, t_end), roundoff, t, q, p);
}

/* Makes one step whose size keeps the local error within the tolerance, no farther than t_end and no larger than the
 * plan's largest_step. A step that ends within roundoff of t_end ends at t_end, so that no tiny step must follow. */
static tvi_status make_step_by_tolerance(run_in_progress *running, double *t, double q[], double p[])
{
    tvi_integrator *it = running->integrator;
    const double t_end = running->plan->t_end, rest = tvi_remaining_time(it, t_end);
    const double largest = running->plan->largest_step;
    const double roundoff = 2 * DBL_EPSILON * fmax(fabs(t_end), fabs(*t));
    const bool is_limited = largest > 0 && fabs(rest) > largest + roundoff;
    const double farthest = is_limited ? copysign(largest, rest) : rest;
    const tvi_status status =
        tvi_make_steps(it, 1, running->plan->tolerance, farthest, tvi_infinite_end_time(farthest), t, q, p);
    running->is_at_end = status == TVI_OK && (it->last_step.h == rest || *t == t_end);
    if (running->is_at_end) tvi_set_time(it, t_end, t);
    return status;
}

/* Makes the next step, or the next steps if nothing needs each of them, multiplies the tangent vectors by the Jacobian
 * matrix of the step, and adds the step to the record. If one of these fails, the step is undone. */
static tvi_status make_next_steps(run_in_progress *running, double *t, double q[], double p[])
{
    tvi_integrator *it = running->integrator;
    const long before = it->stats.steps;
    tvi_status status = running->plan->tolerance > 0 ? make_step_by_tolerance(running, t, q, p)
                        : running->plan->has_t_end   ? make_steps_to_t_end(running, t, q, p)
                                                     : make_steps_of_size_h(running, t, q, p);
    const long made = it->stats.steps - before;
    running->step_count += made > 0 ? made : 1; /* a step of no length to t_end is a step to an observer */
    if (status != TVI_OK) running->is_at_end = false;
    if (status != TVI_OK || made == 0) return status;
    status = tvi_columns_propagate_by_step(it, &running->run->columns);
    if (status == TVI_OK && running->plan->record) {
        status = tvi_record_add_step(running->plan->record, it);
        if (status != TVI_OK) tvi_columns_restore_step_start(it, &running->run->columns);
    }
    if (status == TVI_OK) return TVI_OK;
    tvi_integrator_undo_step(it, t, q, p);
    running->is_at_end = false;
    return status;
}

/* Refuses to go on (TVI_ENOCONV) with a run whose time hardly moves: after RUN_MAX_SLOW_STEPS consecutive steps that
 * each covered less than a 2^53rd of the remaining time. */
static tvi_status check_time_advances(run_in_progress *running, long steps)
{
    const tvi_integrator *it = running->integrator;
    const tvi_run_plan *plan = running->plan;
    const double left = tvi_remaining_time(
        it, plan->time_count > 0 && !plan->has_t_end ? plan->times[plan->time_count - 1] : plan->t_end);
    const bool is_slow = fabs(it->last_step.covered_time) < DBL_EPSILON / 2 * fabs(left);
    running->slow_step_count = is_slow ? running->slow_step_count + steps : 0;
    return running->slow_step_count < RUN_MAX_SLOW_STEPS
               ? TVI_OK
               : jet_refuse(TVI_ENOCONV, "the time hardly moves: by %g in a step, with %g left",
                            it->last_step.covered_time, left);
}

/* Adds an event that is reported to the record of the run. */
static tvi_status record_root(const run_in_progress *running, const tvi_event_root *root, const tvi_event *event)
{
    const double offset = root->theta * running->integrator->last_step.h;
    const int n = running->integrator->system->n;
    const double *x = root->state;
    return running->plan->record ? tvi_record_tell(running->plan->record, event, false, offset, x[2 * n], x, x + n)
                                 : TVI_OK;
}

/* Calls the observer of events with the index of an event and a state [2n + 1]. Returns true if the observer ends the
 * run. */
static bool report_event(const run_in_progress *running, int event_index, const double state[])
{
    const int n = running->integrator->system->n;
    const tvi_observers *observers = &running->run->observers;
    if (!observers->on_event) return false;
    __attribute__((cleanup(end_call))) tvi_integrator *called = running->integrator;
    called->is_in_observer = true;
    return observers->on_event(event_index, state[2 * n], state, state + n, observers->ctx) != 0;
}

/* Ends the run at a root of the last step, and reports the other events that lie there. t, q and p become those of the
 * root. */
static tvi_status stop_at_root(const run_in_progress *running, const tvi_event_root *root, double *t, double q[],
                               double p[])
{
    const size_t n = (size_t)running->integrator->system->n;
    tvi_status status = tvi_events_stop_run(running->events, root);
    if (running->plan->record) tvi_record_mark_exit(running->plan->record);
    for (int event_index = 0; event_index < running->events->event_count && status == TVI_OK; event_index++) {
        if (!running->events->watched_events[event_index].is_unreported_at_stop) continue;
        status = record_root(running, root, running->plan->events[event_index]);
        if (status == TVI_OK) (void)report_event(running, event_index, root->state);
    }
    if (status != TVI_OK) return status;
    *running->integrator->is_state_from_step = false; /* the counts go on, with the largest tail */
    *t = root->state[2 * n];
    memcpy(q, root->state, n * sizeof *q);
    memcpy(p, root->state + n, n * sizeof *p);
    if (running->plan->record)
        status = tvi_record_end_run(running->plan->record, running->integrator, TVI_END_AT_EVENT, *t, q, p);
    return status == TVI_OK ? TVI_ESTOPPED : status;
}

/* Reports a root of the last step, and before it the given times that come first. The tangent vectors become those
 * at the root, if the observer of events may read them, or the user after a terminal event. Returns TVI_ESTOPPED if
 * the run ends there. */
static tvi_status report_root(const run_in_progress *running, const tvi_event_root *root, double *t, double q[],
                              double p[])
{
    tvi_integrator *it = running->integrator;
    const tvi_single_run *run = running->run;
    const bool is_terminal = root->watched->event->is_terminal;
    tvi_status status =
        running->times ? tvi_times_report_until(running->times, root->state[2 * it->system->n]) : TVI_OK;
    if (status == TVI_OK && (run->observers.on_event || is_terminal))
        status = tvi_columns_propagate_to_offset(it, &run->columns, root->theta * it->last_step.h,
                                                 running->events->partial_step.partial_step_integrator->parameters);
    if (status == TVI_OK && (run->observers.on_event || is_terminal))
        status = record_root(running, root, root->watched->event);
    if (status != TVI_OK) return status;
    const bool ends = report_event(running, root->watched->index, root->state) || is_terminal;
    return ends ? stop_at_root(running, root, t, q, p) : TVI_OK;
}

/* Reports the events of the last step, in the order of time. A step that repeats a stop is undone. */
static tvi_status report_events(const run_in_progress *running, double *t, double q[], double p[])
{
    const tvi_tangent_columns *columns = &running->run->columns;
    const tvi_event_search *events = running->events;
    tvi_status status = tvi_events_find(running->events);
    if (events->repeats_stop) {
        tvi_integrator_undo_step(running->integrator, t, q, p);
        tvi_columns_restore_step_start(running->integrator, columns);
        if (running->plan->record) tvi_record_drop_step(running->plan->record);
        return status;
    }
    for (int i = 0; i < events->root_count && status == TVI_OK; i++)
        status = report_root(running, &events->roots[i], t, q, p);
    if (status != TVI_ESTOPPED) tvi_columns_restore_step_end(running->integrator, columns);
    return status;
}

/* Reports the given times and the events that lie in the step just made, and then the step itself, unless an event ends
 * the run in it. */
static tvi_status report_times_events_and_step(const run_in_progress *running, long step, double *t, double q[],
                                               double p[])
{
    const tvi_observers *observers = &running->run->observers;
    tvi_status status = running->times ? tvi_partial_step_set_parameters(&running->times->partial_step) : TVI_OK;
    if (status == TVI_OK && running->events) status = report_events(running, t, q, p);
    if (status == TVI_OK && running->times) status = tvi_times_report_until(running->times, *t);
    if (status != TVI_OK) return status;
    const bool stops = tvi_call_observer(running->integrator, observers->at_step,
                                         running->run->step_count_before_segment + step, *t, q, p, observers->ctx) != 0;
    return stops || (running->times && running->times->is_stopped_by_observer) ? TVI_ESTOPPED : TVI_OK;
}

/* Frees what the run has opened, also where an exception leaves an observer. */
static void close_events(tvi_event_search **events) { tvi_events_close(*events); }
static void close_times(tvi_times_progress *times) { tvi_partial_step_close(&times->partial_step); }
static void close_record(tvi_record **record) { tvi_record_close(record); }

/* An observer that has reset the integrator could step it. */
static tvi_status refuse_steps_of_observer(const tvi_integrator *it, long steps, tvi_status status)
{
    if (it->stats.steps == steps || (status != TVI_OK && status != TVI_ESTOPPED)) return status;
    return jet_refuse(TVI_EINVAL, "an observer has reset the integrator and stepped it, which ends its run");
}

/* Makes steps, and reports what lies in each, until the run ends. A run with given times may continue inside the
 * integrator's last step. */
static tvi_status make_all_steps(run_in_progress *running, bool continues_last_step, double *t, double q[], double p[])
{
    const tvi_run_plan *plan = running->plan;
    tvi_integrator *it = running->integrator;
    const double *const state[] = {q, p};
    const bool has_end_time = plan->has_t_end || plan->tolerance > 0 || plan->time_count > 0;
    __attribute__((cleanup(close_times))) tvi_times_progress times = {.integrator = NULL};
    __attribute__((cleanup(close_events))) tvi_event_search *events = NULL;
    __attribute__((cleanup(close_record))) tvi_record *record = plan->record;
    tvi_status status = tvi_times_open(&times, it, running->run, continues_last_step, *t, q, p);
    const bool has_times = !tvi_times_are_all_reported(&times);
    running->times = has_times ? &times : NULL;
    if (plan->time_count > 0 && !has_times && !plan->has_t_end) running->is_at_end = true;
    if (status == TVI_OK && plan->event_count > 0)
        status = tvi_events_open(&events, it, plan->events, plan->event_count, *t, state);
    running->events = events;
    while (!running->is_at_end && status == TVI_OK) {
        const long before = running->step_count;
        status = make_next_steps(running, t, q, p);
        const long made = it->stats.steps;
        if (status == TVI_OK) status = report_times_events_and_step(running, running->step_count, t, q, p);
        status = refuse_steps_of_observer(it, made, status);
        if (running->times && !plan->has_t_end && tvi_times_are_all_reported(running->times)) running->is_at_end = true;
        if (status == TVI_OK && has_end_time && !running->is_at_end)
            status = check_time_advances(running, running->step_count - before);
    }
    const bool ends_at_time = plan->has_t_end && running->is_at_end;
    const tvi_piece_end end = ends_at_time ? TVI_END_AT_TIME : TVI_END_AT_STEP;
    const tvi_status recorded = record ? tvi_record_end_run(record, it, end, *t, q, p) : TVI_OK;
    return status == TVI_OK ? recorded : status;
}

/* Refuses a t_end that does not lie in the direction of h. */
static tvi_status check_direction(const tvi_run_plan *plan, double t)
{
    if (!plan->has_t_end || plan->tolerance > 0 || (plan->h > 0 ? plan->t_end >= t : plan->t_end <= t)) return TVI_OK;
    return jet_refuse(TVI_EINVAL, "h = %g does not go from t = %g to t_end = %g", plan->h, t, plan->t_end);
}

/* Tells whether the plan ends at the time t, without a step. */
static bool ends_at(const tvi_run_plan *plan, double t)
{
    if (plan->has_t_end || plan->tolerance > 0) return t == plan->t_end;
    return plan->time_count == 0 && plan->steps == 0;
}

/* Runs the integrator. It returns TVI_ESTOPPED if an observer or an event ends the run, and otherwise the status of the
 * step that fails or of the argument that is refused. */
static tvi_status run_integrator(tvi_integrator *it, const tvi_single_run *run, double *t, double q[], double p[])
{
    const tvi_run_plan *plan = run->plan;
    const bool needs_each_step = plan->event_count > 0 || plan->time_count > 0 || run->observers.at_step ||
                                 run->columns.elements || plan->record;
    run_in_progress running = {.integrator = it,
                               .run = run,
                               .plan = plan,
                               .most_steps_per_call = needs_each_step   ? 1
                                                      : plan->has_t_end ? RUN_MAX_SLOW_STEPS
                                                                        : LONG_MAX,
                               .is_at_end = ends_at(plan, *t)};
    const bool has_steps = !running.is_at_end || plan->time_count > 0;
    bool continues_last_step = false;
    tvi_status status = check_direction(plan, *t);
    if (status == TVI_OK && plan->time_count > 0) status = tvi_times_check(it, run, *t, q, p, &continues_last_step);
    if (status == TVI_OK) status = tvi_columns_allocate(it, &run->columns);
    if (status == TVI_OK && run->columns.elements) status = tvi_columns_check_finite(it, &run->columns);
    if (status == TVI_OK && (it->is_in_observer || has_steps)) status = tvi_integrator_begin_step(it, *t, q, p);
    if (status == TVI_OK && has_steps && plan->record) status = tvi_record_begin_run(plan->record, it);
    if (status != TVI_OK || !has_steps) return status;
    /* The low-order part of the time may already have led to t_end. */
    if (plan->has_t_end && tvi_remaining_time(it, plan->t_end) == 0) {
        tvi_set_time(it, plan->t_end, t);
        running.is_at_end = true;
    }
    tvi_columns_store_run_start(it, &run->columns);
    return make_all_steps(&running, continues_last_step, t, q, p);
}

tvi_status tvi_run_observed(tvi_integrator *it, const tvi_run_plan *plan, tvi_observers observers, double *t,
                            double q[], double p[])
{
    if (!it || !t || !q || !p) return tvi_refuse_invalid_run_arguments((tvi_run_arguments){it, t, q, p, 1}, "");
    const tvi_status status = tvi_plan_check(it, plan);
    if (status != TVI_OK) return status;
    const tvi_single_run run = {
        .plan = plan, .observers = observers, .columns = {plan->D, plan->columns, 1, plan->columns_at_once}};
    return run_integrator(it, &run, t, q, p);
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
                    (size_t)member_run->member_count, plan->columns_at_once},
        .step_count_before_segment = member_run->step_count_before_segment,
    };
    return run_integrator(it, &run, t, q, p);
}

tvi_status tvi_run(tvi_integrator *it, const tvi_run_plan *plan, double *t, double q[], double p[])
{
    if (!it || !t || !q || !p) return tvi_refuse_invalid_run_arguments((tvi_run_arguments){it, t, q, p, 1}, "");
    const tvi_status status = tvi_plan_check(it, plan);
    if (status != TVI_OK) return status;
    const tvi_member_run all = {.plan = plan, .member_count = 1, .ensemble_observer = plan->observer};
    return tvi_run_member(it, &all, t, q, p);
}
