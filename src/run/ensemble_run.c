/* ensemble_run.c - runs all members, batch by batch: each as an integrator of its own runs, or all members of a batch
 * at once. */
#include "run/ensemble.h"
#include "run/run.h"
#include "run/spread.h"
#include "system/refuse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What the members do between two calls of the ensemble's observer. */
typedef struct {
    tvi_ensemble *e;
    const tvi_ensemble_plan *plan;
    /* Of one member, whose state the worker has. */
    tvi_status (*go)(const void *turn, tvi_worker *worker, int member, double *t);
    bool at_once; /* steps and nothing else: the members of a batch are stepped together */
    long steps;
    double *t, *q, *p;
    tvi_status *status;
} turn;

/* ---- One member -------------------------------------------------------------------------------------------------- */

/* Who is told of it. */
typedef struct {
    tvi_ensemble *e;
    tvi_member_observer *observer;
    void *ctx;
    int member;
} listener;

static int tell(int which, double t, const double q[], const double p[], void *ctx)
{
    const listener *to = ctx;
    if (!to->observer) return 0;
    (void)pthread_mutex_lock(&to->e->told);
    const int stop = to->observer(to->member, which, t, q, p, to->ctx);
    (void)pthread_mutex_unlock(&to->e->told);
    return stop;
}

static int tell_time(long which, double t, const double q[], const double p[], void *ctx)
{
    return tell((int)which, t, q, p, ctx);
}

static tvi_status go_steps(const void *of, tvi_worker *w, int member, double *t)
{
    const turn *r = of;
    const tvi_ensemble_plan *plan = r->plan;
    listener to = {r->e, plan->on_event, plan->ctx, member};
    return tvi_integrate_events(w->one, plan->h, r->steps, plan->events, plan->event_count, t, w->q, w->p, NULL, tell,
                                &to);
}

static tvi_status go_to(const void *of, tvi_worker *w, int member, double *t)
{
    const turn *r = of;
    const tvi_ensemble_plan *plan = r->plan;
    listener to = {r->e, plan->on_event, plan->ctx, member};
    const tvi_audience audience = {plan->events, plan->event_count, tell, NULL, &to};
    return tvi_run_to(w->one, plan->h, plan->t_end, &audience, t, w->q, w->p);
}

static tvi_status go_within(const void *of, tvi_worker *w, int member, double *t)
{
    const turn *r = of;
    const tvi_ensemble_plan *plan = r->plan;
    listener to = {r->e, plan->on_event, plan->ctx, member};
    return tvi_integrate_tolerance_events(w->one, plan->tolerance, plan->t_end, plan->events, plan->event_count, t,
                                          w->q, w->p, NULL, tell, &to);
}

static tvi_status go_through(const void *of, tvi_worker *w, int member, double *t)
{
    const turn *r = of;
    const tvi_ensemble_plan *plan = r->plan;
    listener to = {r->e, plan->at_time, plan->ctx, member};
    return tvi_integrate_at(w->one, plan->h, plan->times, plan->time_count, t, w->q, w->p, tell_time, &to);
}

/* The member's columns of D, [rows][columns] of the worker's. */
static size_t columns_of(const turn *r)
{
    return (size_t)(2 * r->e->n + tvi_system_parameters(r->e->system)) * (size_t)r->plan->columns;
}

static tvi_status go_tangent(const void *of, tvi_worker *w, int member, double *t)
{
    const turn *r = of;
    const size_t members = (size_t)r->e->members, count = columns_of(r);
    double *D = r->plan->D + member;
    tvi_status status = TVI_OK;
    for (size_t k = 0; k < count; k++) w->D[k] = D[k * members];
    for (long step = 0; step < r->steps && status == TVI_OK; step++)
        status = tvi_step_tangent(w->one, r->plan->h, t, w->q, w->p, w->D, r->plan->columns);
    for (size_t k = 0; k < count; k++) D[k * members] = w->D[k];
    return status;
}

static void gather(const turn *r, tvi_worker *w, int member)
{
    const size_t members = (size_t)r->e->members;
    for (int i = 0; i < r->e->n; i++) {
        w->q[i] = r->q[(size_t)i * members + (size_t)member];
        w->p[i] = r->p[(size_t)i * members + (size_t)member];
    }
}

static void scatter(const turn *r, const tvi_worker *w, int member)
{
    const size_t members = (size_t)r->e->members;
    for (int i = 0; i < r->e->n; i++) {
        r->q[(size_t)i * members + (size_t)member] = w->q[i];
        r->p[(size_t)i * members + (size_t)member] = w->p[i];
    }
}

static void set_status(const turn *r, int member, tvi_status status)
{
    r->status[member] = status;
    r->e->failed[member] = tvi_status_is_of_member(status) ? status : TVI_OK;
}

static void run_member(const turn *r, tvi_worker *w, int member)
{
    const tvi_ensemble *e = r->e;
    gather(r, w, member);
    tvi_worker_enter(w, e, member);
    r->status[member] = e->failed[member];
    if (e->failed[member] != TVI_OK && tvi_integrator_has(w->one, r->t[member], w->q, w->p)) return;
    set_status(r, member, r->go(r, w, member, &r->t[member]));
    scatter(r, w, member);
    tvi_worker_leave(w, e, member);
}

/* ---- A batch of them --------------------------------------------------------------------------------------------- */

/* Makes the user's state that of the member, and says whether it is to be stepped. */
static tvi_status begin_member(const turn *r, tvi_integrator *it, int m, int member)
{
    const tvi_given_state given = {r->q + member, r->p + member, (size_t)r->e->members, r->t[member]};
    const tvi_status failed = r->e->failed[member];
    if (failed != TVI_OK && tvi_member_has(it, m, &given)) return failed;
    return tvi_member_begin(it, m, &given);
}

/* A lane that has no member holds the first one's state, and is not stepped. */
static void fill(tvi_integrator *it, int m)
{
    for (int i = 0; i <= it->stepped->n; i++) it->now.q[i * it->width + m] = it->now.q[i * it->width];
    for (int i = 0; i < it->stepped->n; i++) it->now.p[i * it->width + m] = it->now.p[i * it->width];
    it->status[m] = TVI_EINVAL;
}

static void run_together(const turn *r, tvi_integrator *it, int first, int count)
{
    const size_t members = (size_t)r->e->members;
    tvi_status *begun = r->status + first;
    for (int m = 0; m < count; m++) begun[m] = it->status[m] = begin_member(r, it, m, first + m);
    for (int m = count; m < it->width; m++) fill(it, m);
    tvi_members_step(it, r->steps, r->plan->h);
    for (int m = 0; m < count; m++) {
        const int at = first + m;
        if (begun[m] == TVI_OK) tvi_member_give(it, m, &r->t[at], r->q + at, r->p + at, members);
        set_status(r, at, it->status[m]);
    }
}

static void run_batch(void *ctx, int thread, int batch)
{
    const turn *r = ctx;
    tvi_worker *w = &r->e->worker[thread];
    const int first = tvi_first_member(r->e, batch), count = tvi_members_of(r->e, batch);
    tvi_worker_load(w, r->e, batch);
    if (w->batch->width > 1 && r->at_once) run_together(r, w->batch, first, count);
    else
        for (int member = first; member < first + count; member++) run_member(r, w, member);
    tvi_worker_store(w, r->e, batch);
}

/* ---- The run ----------------------------------------------------------------------------------------------------- */

static tvi_status run_all(const turn *r)
{
    const tvi_ensemble *e = r->e;
    tvi_status status = TVI_OK;
    tvi_spread(e->threads, e->batches, run_batch, (void *)r);
    for (int member = 0; member < e->members; member++)
        if (r->status[member] == TVI_ENOMEM) status = jet_refuse_memory(TVI_ENOMEM);
    r->e->has_run = true;
    return status;
}

/* All steps at once, or one after the other where an observer wants to see them. */
static tvi_status run_steps(turn *r, long steps)
{
    const tvi_ensemble_plan *plan = r->plan;
    tvi_status status = TVI_OK;
    r->steps = plan->observer && steps > 0 ? 1 : steps;
    if (!plan->observer || steps == 0) return run_all(r);
    for (long step = 1; step <= steps && status == TVI_OK; step++) {
        status = run_all(r);
        if (status == TVI_OK && plan->observer(step, r->e->members, r->t, r->q, r->p, r->status, plan->ctx) != 0)
            status = TVI_ESTOPPED;
    }
    return status;
}

/* Room for the columns, in each worker. */
static tvi_status provide_columns(tvi_ensemble *e, const turn *r)
{
    const int columns = r->plan->columns;
    for (int i = 0; i < e->threads && columns > e->columns; i++) {
        tvi_worker *w = &e->worker[i];
        double *D = realloc(w->D, columns_of(r) * sizeof *D);
        if (!D) return jet_refuse_memory(TVI_ENOMEM);
        w->D = D;
        const tvi_status status = tvi_integrator_provide_tangent(w->one, columns);
        if (status != TVI_OK) return status;
    }
    if (columns > e->columns) e->columns = columns;
    return TVI_OK;
}

/* Why these do not go together, or NULL. */
static const char *misfit(const tvi_ensemble_plan *plan)
{
    const bool by_tolerance = plan->tolerance != 0, to_times = plan->time_count != 0, in_steps = plan->steps != 0;
    const struct {
        bool is_so;
        const char *reason;
    } reasons[] = {
        {plan->steps < 0, "steps is negative"},
        {plan->time_count < 0 || plan->event_count < 0 || plan->columns < 0, "a count is negative"},
        {plan->columns > 0 && !plan->D, "D is NULL"},
        {to_times && !plan->times, "times is NULL"},
        {by_tolerance && plan->h != 0, "h and tolerance are both given"},
        {!by_tolerance && (plan->h == 0 || !isfinite(plan->h)), "h is 0 or not finite"},
        {in_steps && by_tolerance, "steps and tolerance are both given: a tolerance goes to t_end"},
        {to_times && by_tolerance, "times and tolerance are both given: a tolerance goes to t_end"},
        {in_steps && to_times, "steps and time_count are both given"},
        {in_steps && plan->t_end != 0, "steps and t_end are both given"},
        {to_times && plan->t_end != 0, "times and t_end are both given"},
        {plan->times && !to_times, "times is given, and time_count is 0"},
        {plan->at_time && !to_times, "at_time is given, and time_count is 0"},
        {plan->on_event && plan->event_count == 0, "on_event is given, and event_count is 0"},
        {plan->event_count > 0 && !plan->events, "event_count is given, and events is NULL"},
        {plan->D && plan->columns == 0, "D is given, and columns is 0"},
        {to_times && plan->event_count > 0, "times and event_count are both given: times have no events"},
        {plan->columns > 0 && !in_steps, "D is given without steps: it goes with steps alone"},
        {plan->columns > 0 && plan->event_count > 0, "D and event_count are both given: D goes with steps alone"},
        {plan->observer && !in_steps, "observer is given without steps: it goes with steps alone"},
        {plan->observer && plan->event_count > 0, "observer and event_count are both given"},
        {!isfinite(plan->t_end), "t_end is not finite"},
    };
    for (size_t i = 0; i < sizeof reasons / sizeof *reasons; i++)
        if (reasons[i].is_so) return reasons[i].reason;
    return NULL;
}

static tvi_status refuse_null(const tvi_ensemble *e, const double t[], const double q[], const double p[],
                              const tvi_status status[])
{
    return tvi_refuse_null(5, (const void *const[]){e, t, q, p, status},
                           (const char *const[]){"ensemble", "t", "q", "p", "status"});
}

tvi_status tvi_ensemble_run(tvi_ensemble *e, const tvi_ensemble_plan *plan, double t[], double q[], double p[],
                            tvi_status status[])
{
    if (!e || !t || !q || !p || !status) return refuse_null(e, t, q, p, status);
    const char *const reason = plan ? misfit(plan) : "plan is NULL";
    if (reason) return jet_refuse(TVI_EINVAL, "%s", reason);
    const tvi_integrator *it = e->worker->one;
    if (!tvi_events_fit(it, plan->events, plan->event_count)) return TVI_EINVAL;
    const tvi_status served = plan->tolerance != 0 ? tvi_serves_tolerance(it, plan->tolerance) : TVI_OK;
    if (served != TVI_OK) return served;
    turn r = {.e = e, .plan = plan, .t = t, .q = q, .p = p, .status = status};
    const tvi_status provided = provide_columns(e, &r);
    if (provided != TVI_OK) return provided;
    r.at_once = plan->steps > 0 && plan->event_count == 0 && plan->columns == 0;
    r.go = plan->columns > 0      ? go_tangent
           : plan->steps > 0      ? go_steps
           : plan->time_count > 0 ? go_through
           : plan->tolerance != 0 ? go_within
                                  : go_to;
    return plan->steps > 0 ? run_steps(&r, plan->steps) : run_all(&r);
}

tvi_status tvi_ensemble_integrate(tvi_ensemble *e, double h, long steps, double t[], double q[], double p[],
                                  tvi_status status[], tvi_ensemble_observer *observer, void *ctx)
{
    if (!e || !t || !q || !p || !status) return refuse_null(e, t, q, p, status);
    if (h == 0 || !isfinite(h)) return jet_refuse(TVI_EINVAL, "h is 0 or not finite");
    if (steps < 0) return jet_refuse(TVI_EINVAL, "steps is negative");
    const tvi_ensemble_plan plan = {.h = h, .observer = observer, .ctx = ctx};
    turn r = {e, &plan, go_steps, true, 0, t, q, p, status};
    return run_steps(&r, steps);
}
