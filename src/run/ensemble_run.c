/* ensemble_run.c - Runs all members of an ensemble in several threads. A thread loads one member after the other into
 * its integrator, runs this integrator by the plan, and stores the member. */
#include "run/ensemble.h"
#include "system/refuse.h"

/* A member in the integrator of a thread. */
typedef struct {
    tvi_ensemble *ensemble;
    tvi_ensemble_worker *worker;
    int member;
    double t;
} loaded_member;

static loaded_member load_member(tvi_ensemble *ensemble, int thread, int member)
{
    const tvi_ensemble_segment *segment = &ensemble->segment;
    tvi_ensemble_worker *worker = &ensemble->workers[thread];
    tvi_gather_member(ensemble->n, ensemble->member_count, segment->q, member, worker->member_q);
    tvi_gather_member(ensemble->n, ensemble->member_count, segment->p, member, worker->member_p);
    tvi_worker_load_member(worker, ensemble, member);
    return (loaded_member){ensemble, worker, member, segment->t[member]};
}

/* Stores the member and what it has reached, also where an exception leaves an observer. */
static void store_member(loaded_member *loaded)
{
    tvi_ensemble *ensemble = loaded->ensemble;
    const tvi_ensemble_segment *segment = &ensemble->segment;
    segment->t[loaded->member] = loaded->t;
    tvi_scatter_member(ensemble->n, ensemble->member_count, loaded->worker->member_q, loaded->member, segment->q);
    tvi_scatter_member(ensemble->n, ensemble->member_count, loaded->worker->member_p, loaded->member, segment->p);
    tvi_worker_store_member(loaded->worker, ensemble, loaded->member);
}

static void run_member_in_thread(void *ctx, int thread, int member)
{
    tvi_ensemble *ensemble = ctx;
    const tvi_ensemble_segment *segment = &ensemble->segment;
    tvi_status *status = &segment->member_status[member], *failed = &ensemble->failure_status[member];
    /* An observer or an event has stopped this member in an earlier segment. */
    if (segment->step_count_before_segment > 0 && *status == TVI_ESTOPPED) return;
    __attribute__((cleanup(store_member))) loaded_member loaded = load_member(ensemble, thread, member);
    tvi_integrator *it = loaded.worker->integrator;
    double *q = loaded.worker->member_q, *p = loaded.worker->member_p;
    *status = *failed;
    if (*failed != TVI_OK && tvi_integrator_state_equals(it, loaded.t, q, p)) return;
    const tvi_member_run run = {.plan = &segment->plan,
                                .member_index = member,
                                .member_count = ensemble->member_count,
                                .step_count_before_segment = segment->step_count_before_segment,
                                .team = &ensemble->team,
                                .observer_lock = &ensemble->observer_lock};
    *status = tvi_run_member(it, &run, &loaded.t, q, p);
    *failed = tvi_is_failure_of_member(*status) ? *status : TVI_OK;
}

/* ---- The run ----------------------------------------------------------------------------------------------------- */

/* Allows other calls after a run, also where an exception has left an observer. */
static void end_run(tvi_ensemble **ensemble)
{
    (*ensemble)->is_running = false;
    (*ensemble)->has_run = true;
}

static tvi_status run_all_members(tvi_ensemble *given, const tvi_ensemble_segment *segment)
{
    __attribute__((cleanup(end_run))) tvi_ensemble *ensemble = given;
    tvi_status status = TVI_OK;
    ensemble->is_running = true;
    ensemble->segment = *segment;
    tvi_parallel_for(&ensemble->team, ensemble->member_count, run_member_in_thread, ensemble);
    for (int member = 0; member < ensemble->member_count; member++)
        if (segment->member_status[member] == TVI_ENOMEM) status = jet_explain_out_of_memory(TVI_ENOMEM);
    return status;
}

/* Makes all steps of the run. With an observer of the ensemble each step is a segment, after which the observer is
 * called. Without an observer all steps are one segment. */
static tvi_status run_all_segments(tvi_ensemble *ensemble, tvi_ensemble_segment segment)
{
    const long steps = segment.plan.steps;
    tvi_ensemble_observer *observer = segment.plan.observer;
    if (!observer || steps == 0) return run_all_members(ensemble, &segment);
    segment.plan.steps = 1;
    for (long step = 1; step <= steps; step++) {
        segment.step_count_before_segment = step - 1;
        const tvi_status status = run_all_members(ensemble, &segment);
        if (status != TVI_OK) return status;
        if (observer(step, ensemble->member_count, segment.t, segment.q, segment.p, segment.member_status,
                     segment.plan.ctx) != 0)
            return TVI_ESTOPPED;
    }
    return TVI_OK;
}

/* Prepares the integrators of all threads and the members for tangent vectors, if the run has columns. */
static tvi_status allocate_tangents(const tvi_ensemble *ensemble, int column_count)
{
    tvi_integrator *first = ensemble->workers->integrator;
    tvi_status status = TVI_OK;
    if (column_count == 0) return TVI_OK;
    for (int i = 0; i < ensemble->thread_count && status == TVI_OK; i++)
        status = tvi_integrator_allocate_tangents(ensemble->workers[i].integrator, 0);
    for (int m = 0; m < ensemble->member_count && status == TVI_OK; m++) {
        tvi_step_columns_exchange(first, &ensemble->columns[m]);
        status = tvi_integrator_allocate_tangents(first, column_count);
        tvi_step_columns_exchange(first, &ensemble->columns[m]);
    }
    return status;
}

tvi_status tvi_ensemble_run(tvi_ensemble *ensemble, const tvi_ensemble_plan *plan, double t[], double q[], double p[],
                            tvi_status status[])
{
    if (!ensemble || !t || !q || !p || !status)
        return tvi_refuse_first_null_pointer(5, (const void *const[]){ensemble, t, q, p, status},
                                             (const char *const[]){"ensemble", "t", "q", "p", "status"});
    tvi_status checked = tvi_ensemble_refuse_if_running(ensemble);
    if (checked == TVI_OK) checked = tvi_plan_check(ensemble->workers->integrator, plan);
    if (checked == TVI_OK && plan->record)
        checked = jet_refuse(TVI_EUNSUPPORTED, "an ensemble has no record: gradients are for integrators");
    if (checked != TVI_OK) return checked;
    if (plan->columns_at_once)
        return jet_refuse(TVI_EUNSUPPORTED, "columns_at_once is for tvi_run: members move each column alone");
    const tvi_status provided = allocate_tangents(ensemble, plan->columns);
    if (provided != TVI_OK) return provided;
    return run_all_segments(ensemble, (tvi_ensemble_segment){*plan, 0, t, q, p, status});
}

tvi_status tvi_ensemble_integrate(tvi_ensemble *ensemble, double h, long steps, double t[], double q[], double p[],
                                  tvi_status status[], tvi_ensemble_observer *observer, void *ctx)
{
    const tvi_run_plan plan = {.h = h, .steps = steps, .observer = observer, .ctx = ctx};
    return tvi_ensemble_run(ensemble, &plan, t, q, p, status);
}
