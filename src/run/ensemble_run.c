/* ensemble_run.c - Runs all members of an ensemble, batch by batch. A batch is stepped as a whole, or its members run
 * one after the other as an integrator does. */
#include "run/ensemble.h"
#include "run/plan.h"
#include "run/parallel_for.h"
#include "method/single.h"
#include "system/refuse.h"

#include <math.h>

/* A piece of a run: what the members do between two calls of the ensemble's observer. */
typedef struct {
    tvi_ensemble *e;
    tvi_run_plan plan; /* of this piece */
    tvi_run_mode mode;
    /* The run consists of steps alone, so that the members of a batch are stepped together. */
    bool at_once;
    long steps_reported; /* steps of the pieces before this one */
    double *t, *q, *p;
    tvi_status *status;
} piece;

/* ---- One member -------------------------------------------------------------------------------------------------- */

static void set_status(const piece *r, int member, tvi_status status)
{
    r->status[member] = status;
    r->e->failed[member] = tvi_status_is_of_member(status) ? status : TVI_OK;
}

static void run_member(const piece *r, tvi_worker *w, int member)
{
    const tvi_ensemble *e = r->e;
    if (r->steps_reported > 0 && r->status[member] == TVI_ESTOPPED) return; /* in an earlier piece */
    tvi_gather(e->n, e->members, r->q, member, w->q);
    tvi_gather(e->n, e->members, r->p, member, w->p);
    tvi_worker_load_member(w, e, member);
    if (e->failed[member] != TVI_OK && tvi_integrator_has_state(w->single, r->t[member], w->q, w->p)) {
        r->status[member] = e->failed[member];
        return;
    }
    const tvi_member_run run = {.plan = &r->plan,
                                .mode = r->mode,
                                .member = member,
                                .members = e->members,
                                .steps_reported = r->steps_reported,
                                .lock = &r->e->observer_lock};
    set_status(r, member, tvi_run_member(w->single, &run, &r->t[member], w->q, w->p));
    tvi_scatter(e->n, e->members, w->q, member, r->q);
    tvi_scatter(e->n, e->members, w->p, member, r->p);
    tvi_worker_store_member(w, e, member);
}

/* ---- A batch of them --------------------------------------------------------------------------------------------- */

/* Loads the user's state into the member, and returns the status that says whether the member is stepped. */
static tvi_status begin_member(const piece *r, tvi_integrator *it, int m, int member)
{
    const tvi_given_state given = {r->q + member, r->p + member, (size_t)r->e->members, r->t[member]};
    const tvi_status failed = r->e->failed[member];
    if (failed != TVI_OK && tvi_member_has_state(it, m, &given)) return failed;
    return tvi_member_begin(it, m, &given);
}

/* Fills a lane that has no member with the first lane's state. Such a lane is not stepped. */
static void fill(tvi_integrator *it, int m)
{
    for (int i = 0; i <= it->stepped->n; i++) it->state.q[i * it->width + m] = it->state.q[i * it->width];
    for (int i = 0; i < it->stepped->n; i++) it->state.p[i * it->width + m] = it->state.p[i * it->width];
    it->status[m] = TVI_EINVAL;
}

static void run_together(const piece *r, tvi_integrator *it, int first, int count)
{
    const size_t members = (size_t)r->e->members;
    tvi_status *begun = r->status + first;
    for (int m = 0; m < count; m++) begun[m] = it->status[m] = begin_member(r, it, m, first + m);
    for (int m = count; m < it->width; m++) fill(it, m);
    tvi_members_step(it, r->plan.steps, r->plan.h);
    for (int m = 0; m < count; m++) {
        const int at = first + m;
        if (begun[m] == TVI_OK) tvi_member_copy_state(it, m, &r->t[at], r->q + at, r->p + at, members);
        set_status(r, at, it->status[m]);
    }
}

static void run_batch(void *ctx, int thread, int batch)
{
    const piece *r = ctx;
    tvi_worker *w = &r->e->worker[thread];
    const int first = tvi_first_member(r->e, batch), count = tvi_members_of(r->e, batch);
    tvi_worker_load(w, r->e, batch);
    if (w->batch->width > 1 && r->at_once) run_together(r, w->batch, first, count);
    else
        for (int member = first; member < first + count; member++) run_member(r, w, member);
    tvi_worker_store(w, r->e, batch);
}

/* ---- The run ----------------------------------------------------------------------------------------------------- */

static tvi_status run_all(const piece *r)
{
    const tvi_ensemble *e = r->e;
    tvi_status status = TVI_OK;
    r->e->is_running = true;
    tvi_parallel_for(e->threads, e->batches, run_batch, (void *)r);
    r->e->is_running = false;
    for (int member = 0; member < e->members; member++)
        if (r->status[member] == TVI_ENOMEM) status = jet_refuse_memory(TVI_ENOMEM);
    r->e->has_run = true;
    return status;
}

/* Makes all steps at once, or one after the other if an observer is called after each. */
static tvi_status run_steps(piece *r)
{
    const long steps = r->plan.steps;
    tvi_ensemble_observer *observer = r->plan.observer;
    if (!observer || steps == 0) return run_all(r);
    r->plan.steps = 1;
    for (long step = 1; step <= steps; step++) {
        r->steps_reported = step - 1;
        const tvi_status status = run_all(r);
        if (status != TVI_OK) return status;
        if (observer(step, r->e->members, r->t, r->q, r->p, r->status, r->plan.ctx) != 0) return TVI_ESTOPPED;
    }
    return TVI_OK;
}

/* Provides memory for the columns in every worker. */
static tvi_status provide_columns(const tvi_ensemble *e, int columns)
{
    tvi_status status = TVI_OK;
    for (int i = 0; i < e->threads && columns > 0 && status == TVI_OK; i++)
        status = tvi_integrator_allocate_tangent(e->worker[i].single, columns);
    return status;
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
    tvi_status checked = tvi_ensemble_check_idle(e);
    if (checked == TVI_OK) checked = tvi_plan_check(e->worker->single, plan);
    if (checked != TVI_OK) return checked;
    const tvi_status provided = provide_columns(e, plan->columns);
    if (provided != TVI_OK) return provided;
    const bool at_once = plan->steps > 0 && plan->event_count == 0 && plan->columns == 0 && !plan->at_step;
    piece r = {e, *plan, tvi_plan_mode(plan), at_once, 0, t, q, p, status};
    return r.mode == TVI_RUN_STEPS ? run_steps(&r) : run_all(&r);
}

tvi_status tvi_ensemble_integrate(tvi_ensemble *e, double h, long steps, double t[], double q[], double p[],
                                  tvi_status status[], tvi_ensemble_observer *observer, void *ctx)
{
    if (!e || !t || !q || !p || !status) return refuse_null(e, t, q, p, status);
    if (h == 0 || !isfinite(h)) return jet_refuse(TVI_EINVAL, "h is 0 or not finite");
    if (steps < 0) return jet_refuse(TVI_EINVAL, "steps is negative");
    const tvi_status idle = tvi_ensemble_check_idle(e);
    if (idle != TVI_OK) return idle;
    const tvi_run_plan plan = {.h = h, .steps = steps, .observer = observer, .ctx = ctx};
    piece r = {e, plan, TVI_RUN_STEPS, true, 0, t, q, p, status};
    return run_steps(&r);
}
