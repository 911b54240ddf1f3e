/* times.c - tells the results at given times of a run: each is the state of a step of the method, of the part of the
 * last step that leads there (between.h). */
#include "run/times.h"
#include "run/columns.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <math.h>

/* The first time that is not finite, or not in the order of h, or before t; count where there is none. */
static int first_out_of_order(double h, double t, const double times[], int count)
{
    for (int i = 0; i < count; i++) {
        const double before = i > 0 ? times[i - 1] : t;
        if (!isfinite(times[i]) || (h > 0 ? times[i] < before : times[i] > before)) return i;
    }
    return count;
}

/* Whether the state is the end of the last step, which went the way of h, and still has all that it left. */
static bool has_last_step(const tvi_integrator *it, double h, double t, const double q[], const double p[])
{
    return *it->continues && it->has_dense && (h > 0) == (it->h > 0) && tvi_integrator_has(it, t, q, p);
}

tvi_status tvi_times_check(const tvi_integrator *it, const tvi_run_of_one *run, double t, const double q[],
                           const double p[], bool *has_step)
{
    const int n = it->system->n, count = run->plan->time_count;
    const double h = run->plan->h, *times = run->plan->times;
    if (count < 0) return jet_refuse(TVI_EINVAL, "count is negative");
    if (count > 0 && !times) return jet_refuse(TVI_EINVAL, "times is NULL");
    if (!tvi_all_finite(n, q) || !tvi_all_finite(n, p)) return tvi_refuse_state(n, t, q, "p", p);
    *has_step = has_last_step(it, h, t, q, p) && tvi_columns_have_last_step(it, &run->columns);
    const int first = first_out_of_order(h, *has_step ? it->start.q[n] : t, times, count);
    return first == count
               ? TVI_OK
               : jet_refuse(TVI_EINVAL, "times[%d] = %g is not in order, or not finite", first, times[first]);
}

/* Tells one more, with its state. */
static void tell_next(tvi_times *s, const double q[], const double p[])
{
    const tvi_audience *to = &s->run->audience;
    const int which = s->next++;
    const double time = s->run->plan->times[which];
    if (tvi_tell_step(s->it, to->at_time, which + 1, time, q, p, to->ctx) != 0) s->is_stopped = true;
}

/* Tells one of the last step. */
static tvi_status tell_inside(tvi_times *s)
{
    const tvi_between *between = &s->between;
    tvi_status status = tvi_between_time(&s->between, s->run->plan->times[s->next]);
    if (status == TVI_OK && s->run->audience.at_time)
        status = tvi_columns_show(s->it, &s->run->columns, between->part, between->partial->parameters);
    if (status == TVI_OK) tell_next(s, between->q, between->p);
    return status;
}

/* Tells those up to this one; all of them, or until the observer stops the run. */
static tvi_status tell_until(tvi_times *s, double until, bool all)
{
    const tvi_run_plan *plan = s->run->plan;
    const double way = plan->h > 0 ? 1 : -1;
    const int first = s->next;
    tvi_status status = TVI_OK;
    while (status == TVI_OK && !tvi_times_are_told(s) && way * (plan->times[s->next] - until) <= 0 &&
           (all || !s->is_stopped))
        status = tell_inside(s);
    if (s->next > first) tvi_columns_to_end(s->it, &s->run->columns);
    return status;
}

tvi_status tvi_times_tell(tvi_times *s, double until) { return tell_until(s, until, s->run->plan->event_count > 0); }

bool tvi_times_are_told(const tvi_times *s) { return s->next == s->run->plan->time_count; }

tvi_status tvi_times_set_parameters(tvi_times *s) { return tvi_between_set_parameters(&s->between); }

tvi_status tvi_times_open(tvi_times *s, tvi_integrator *it, const tvi_run_of_one *run, bool has_step, double t,
                          const double q[], const double p[])
{
    *s = (tvi_times){.it = it, .run = run};
    while (!has_step && !s->is_stopped && !tvi_times_are_told(s) && run->plan->times[s->next] == t) {
        tell_next(s, q, p);
        tvi_columns_to_end(it, &run->columns);
    }
    if (s->is_stopped || tvi_times_are_told(s)) return s->is_stopped ? TVI_ESTOPPED : TVI_OK;
    tvi_status status = tvi_between_open(&s->between, it, false);
    if (status == TVI_OK && has_step) status = tell_until(s, t, false);
    return status == TVI_OK && s->is_stopped ? TVI_ESTOPPED : status;
}

void tvi_times_close(tvi_times *s)
{
    if (s->between.steps) tvi_between_close(&s->between);
}

tvi_status tvi_integrate_at(tvi_integrator *it, double h, const double times[], int count, double *t, double q[],
                            double p[], tvi_observer *observer, void *ctx)
{
    const tvi_run_plan plan = {.h = h, .times = times, .time_count = count};
    const tvi_audience audience = {.at_time = observer, .ctx = ctx};
    return tvi_run_one(it, &(tvi_run_of_one){.way = TVI_THROUGH_TIMES, .plan = &plan, .audience = audience}, t, q, p);
}
