/* times.c - Reports the states at the given times of a run (times.h). Each state is computed by a partial step of the
 * method from the start of the last step (inside_step.h). */
#include "run/times.h"
#include "run/record.h"
#include "system/refuse.h"

#include <math.h>

/* Returns the index of the first given time that is not finite, or not in the direction of h from the time before it.
 * Returns `count` if there is none. */
static int find_first_time_out_of_order(double h, double t, const double times[], int count)
{
    for (int i = 0; i < count; i++) {
        const double before = i > 0 ? times[i - 1] : t;
        if (!isfinite(times[i]) || (h > 0 ? times[i] < before : times[i] > before)) return i;
    }
    return count;
}

/* Tells whether the given state is the end of the integrator's last step, which went in the direction of h, and from
 * whose start partial steps can still be made. */
static bool does_last_step_end_at_state(const tvi_integrator *it, double h, double t, const double q[],
                                        const double p[])
{
    return *it->is_state_from_step && it->last_step.has_curve && (h > 0) == (it->last_step.h > 0) &&
           tvi_integrator_state_equals(it, t, q, p);
}

tvi_status tvi_times_check(const tvi_integrator *it, const tvi_single_run *run, double t, const double q[],
                           const double p[], bool *continues_last_step)
{
    const int count = run->plan->time_count;
    const double h = run->plan->h, *times = run->plan->times;
    *continues_last_step =
        does_last_step_end_at_state(it, h, t, q, p) && tvi_columns_match_last_step_end(it, &run->columns);
    const int first =
        find_first_time_out_of_order(h, *continues_last_step ? it->last_step.start.q[it->system->n] : t, times, count);
    if (first < count)
        return jet_refuse(TVI_EINVAL, "times[%d] = %g is not in order, or not finite", first, times[first]);
    return !run->plan->has_t_end ||
                   (h > 0 ? times[count - 1] <= run->plan->t_end : times[count - 1] >= run->plan->t_end)
               ? TVI_OK
               : jet_refuse(TVI_EINVAL, "times[%d] = %g is beyond t_end = %g", count - 1, times[count - 1],
                            run->plan->t_end);
}

/* Reports the next given time with its state q, p, by calling the observer. */
static void report_state_at_next_time(tvi_times_progress *times_progress, const double q[], const double p[])
{
    const tvi_observers *observers = &times_progress->run->observers;
    const int which = times_progress->next_time_index++;
    const double time = times_progress->run->plan->times[which];
    if (tvi_call_observer(times_progress->integrator, observers->at_time, which + 1, time, q, p, observers->ctx) != 0)
        times_progress->is_stopped_by_observer = true;
}

/* Computes the state at the next given time, which lies in the last step, and reports the state. */
static tvi_status report_next_time_in_step(tvi_times_progress *times_progress)
{
    const tvi_partial_step *partial_step = &times_progress->partial_step;
    tvi_status status = tvi_partial_step_to_time(&times_progress->partial_step,
                                                 times_progress->run->plan->times[times_progress->next_time_index]);
    if (status == TVI_OK && times_progress->run->observers.at_time)
        status = tvi_columns_propagate_to_offset(times_progress->integrator, &times_progress->run->columns,
                                                 partial_step->stored_state_offset,
                                                 partial_step->partial_step_integrator->parameters);
    tvi_record *record = times_progress->run->plan->record;
    const int n = times_progress->integrator->system->n;
    const double *q = partial_step->state;
    if (status == TVI_OK && record)
        status = tvi_record_tell(record, NULL, false, partial_step->stored_state_offset, q[2 * n], q, q + n);
    if (status == TVI_OK) report_state_at_next_time(times_progress, q, q + n);
    return status;
}

/* Reports the given times up to last_time. After the observer has stopped the run, no further time is reported, unless
 * ignores_observer_stop is true. */
static tvi_status report_times_until(tvi_times_progress *times_progress, double last_time, bool ignores_observer_stop)
{
    const tvi_run_plan *plan = times_progress->run->plan;
    const double direction = plan->h > 0 ? 1 : -1;
    const int first = times_progress->next_time_index;
    tvi_status status = TVI_OK;
    while (status == TVI_OK && !tvi_times_are_all_reported(times_progress) &&
           direction * (plan->times[times_progress->next_time_index] - last_time) <= 0 &&
           (ignores_observer_stop || !times_progress->is_stopped_by_observer))
        status = report_next_time_in_step(times_progress);
    if (times_progress->next_time_index > first)
        tvi_columns_restore_step_end(times_progress->integrator, &times_progress->run->columns);
    return status;
}

tvi_status tvi_times_report_until(tvi_times_progress *times_progress, double last_time)
{
    return report_times_until(times_progress, last_time, times_progress->run->plan->event_count > 0);
}

bool tvi_times_are_all_reported(const tvi_times_progress *times_progress)
{
    return times_progress->next_time_index == times_progress->run->plan->time_count;
}

tvi_status tvi_times_open(tvi_times_progress *times_progress, tvi_integrator *it, const tvi_single_run *run,
                          bool continues_last_step, double t, const double q[], const double p[])
{
    *times_progress = (tvi_times_progress){.integrator = it, .run = run};
    while (!continues_last_step && !times_progress->is_stopped_by_observer &&
           !tvi_times_are_all_reported(times_progress) && run->plan->times[times_progress->next_time_index] == t) {
        if (run->plan->record) {
            const tvi_status told = tvi_record_tell(run->plan->record, NULL, true, 0, t, q, p);
            if (told != TVI_OK) return told;
        }
        report_state_at_next_time(times_progress, q, p);
        tvi_columns_restore_step_end(it, &run->columns);
    }
    if (times_progress->is_stopped_by_observer || tvi_times_are_all_reported(times_progress))
        return times_progress->is_stopped_by_observer ? TVI_ESTOPPED : TVI_OK;
    tvi_status status = tvi_partial_step_open(&times_progress->partial_step, it, false);
    if (status == TVI_OK && continues_last_step) status = report_times_until(times_progress, t, false);
    return status == TVI_OK && times_progress->is_stopped_by_observer ? TVI_ESTOPPED : status;
}
