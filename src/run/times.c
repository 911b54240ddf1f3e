/* times.c - Reports the results at given times of a run. Each is the state after a step of the method over the part of
 * the last step that leads there (between.h). */
#include "run/times.h"
#include "run/columns.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <math.h>

/* The index of the first time that is not finite, or not in the order of h, or before t; otherwise count. */
static int first_out_of_order(double h, double t, const double times[], int count)
{
    for (int i = 0; i < count; i++) {
        const double before = i > 0 ? times[i - 1] : t;
        if (!isfinite(times[i]) || (h > 0 ? times[i] < before : times[i] > before)) return i;
    }
    return count;
}

/* Tells whether the state is the end of the last step, in the direction of h, and all that this step left is still
 * there. */
static bool last_step_ends_here(const tvi_integrator *it, double h, double t, const double q[], const double p[])
{
    return *it->continues && it->has_dense && (h > 0) == (it->h > 0) && tvi_integrator_has_state(it, t, q, p);
}

tvi_status tvi_times_check(const tvi_integrator *it, const tvi_run_of_one *run, double t, const double q[],
                           const double p[], bool *has_step)
{
    const int n = it->system->n, count = run->plan->time_count;
    const double h = run->plan->h, *times = run->plan->times;
    if (count < 0) return jet_refuse(TVI_EINVAL, "count is negative");
    if (count > 0 && !times) return jet_refuse(TVI_EINVAL, "times is NULL");
    if (!tvi_all_finite(n, q) || !tvi_all_finite(n, p)) return tvi_refuse_state(n, t, q, "p", p);
    *has_step = last_step_ends_here(it, h, t, q, p) && tvi_columns_have_last_step(it, &run->columns);
    const int first = first_out_of_order(h, *has_step ? it->start.q[n] : t, times, count);
    return first == count
               ? TVI_OK
               : jet_refuse(TVI_EINVAL, "times[%d] = %g is not in order, or not finite", first, times[first]);
}

/* Reports the next time, with its state. */
static void report_next(tvi_times *s, const double q[], const double p[])
{
    const tvi_observers *observers = &s->run->observers;
    const int which = s->next++;
    const double time = s->run->plan->times[which];
    if (tvi_call_observer(s->it, observers->at_time, which + 1, time, q, p, observers->ctx) != 0) s->is_stopped = true;
}

/* Reports the next time, which is in the last step. */
static tvi_status report_inside(tvi_times *s)
{
    const tvi_between *between = &s->between;
    tvi_status status = tvi_between_time(&s->between, s->run->plan->times[s->next]);
    if (status == TVI_OK && s->run->observers.at_time)
        status = tvi_columns_show(s->it, &s->run->columns, between->part, between->partial_integrator->parameters);
    if (status == TVI_OK) report_next(s, between->q, between->p);
    return status;
}

/* Reports the times up to `until`: all of them, or until the observer stops the run. */
static tvi_status report_until(tvi_times *s, double until, bool all)
{
    const tvi_run_plan *plan = s->run->plan;
    const double way = plan->h > 0 ? 1 : -1;
    const int first = s->next;
    tvi_status status = TVI_OK;
    while (status == TVI_OK && !tvi_times_are_reported(s) && way * (plan->times[s->next] - until) <= 0 &&
           (all || !s->is_stopped))
        status = report_inside(s);
    if (s->next > first) tvi_columns_to_end(s->it, &s->run->columns);
    return status;
}

tvi_status tvi_times_report(tvi_times *s, double until)
{
    return report_until(s, until, s->run->plan->event_count > 0);
}

bool tvi_times_are_reported(const tvi_times *s) { return s->next == s->run->plan->time_count; }

tvi_status tvi_times_set_parameters(tvi_times *s) { return tvi_between_set_parameters(&s->between); }

tvi_status tvi_times_open(tvi_times *s, tvi_integrator *it, const tvi_run_of_one *run, bool has_step, double t,
                          const double q[], const double p[])
{
    *s = (tvi_times){.it = it, .run = run};
    while (!has_step && !s->is_stopped && !tvi_times_are_reported(s) && run->plan->times[s->next] == t) {
        report_next(s, q, p);
        tvi_columns_to_end(it, &run->columns);
    }
    if (s->is_stopped || tvi_times_are_reported(s)) return s->is_stopped ? TVI_ESTOPPED : TVI_OK;
    tvi_status status = tvi_between_open(&s->between, it, false);
    if (status == TVI_OK && has_step) status = report_until(s, t, false);
    return status == TVI_OK && s->is_stopped ? TVI_ESTOPPED : status;
}

void tvi_times_close(tvi_times *s)
{
    if (s->between.integrator) tvi_between_close(&s->between);
}

tvi_status tvi_integrate_at(tvi_integrator *it, double h, const double times[], int count, double *t, double q[],
                            double p[], tvi_observer *observer, void *ctx)
{
    const tvi_run_plan plan = {.h = h, .times = times, .time_count = count};
    const tvi_observers observers = {.at_time = observer, .ctx = ctx};
    return tvi_run_one(it, &(tvi_run_of_one){.mode = TVI_RUN_AT_TIMES, .plan = &plan, .observers = observers}, t, q, p);
}
