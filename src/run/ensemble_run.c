/* ensemble_run.c - Runs all members of an ensemble in several threads, one batch of members after the other. The
 * members of a batch are stepped together if the plan gives a number of steps, and has no observer of members, no
 * events and no tangent vectors. Otherwise each member runs alone, by an integrator for a single member. */
#include "run/ensemble.h"
#include "run/plan.h"
#include "run/parallel_for.h"
#include "method/single.h"
#include "system/refuse.h"

#include <math.h>

/* A segment of an ensemble's run: the steps of all members between two calls of the ensemble's own observer, or all
 * steps if there is no observer. */
typedef struct {
    tvi_ensemble *ensemble;
    tvi_run_plan plan; /* the plan of the run, with the number of steps of this segment */
    tvi_run_mode run_mode;
    /* True if the members of a batch are stepped together, which is possible if nothing is reported inside the
     * segment. */
    bool steps_members_together;
    long step_count_before_segment; /* the number of steps in earlier segments of the run */
    double *t, *q, *p;              /* the user's arrays of all members' states */
    tvi_status *member_status;      /* [member_count] the user's array of the members' statuses */
} run_between_observer_calls;

/* ---- One member -------------------------------------------------------------------------------------------------- */

static void set_member_status(const run_between_observer_calls *segment, int member, tvi_status status)
{
    segment->member_status[member] = status;
    segment->ensemble->failure_status[member] = tvi_is_failure_of_one_member_only(status) ? status : TVI_OK;
}

static void run_single_member(const run_between_observer_calls *segment, tvi_ensemble_worker *worker, int member)
{
    const tvi_ensemble *ensemble = segment->ensemble;
    /* An observer or an event has stopped this member in an earlier segment. */
    if (segment->step_count_before_segment > 0 && segment->member_status[member] == TVI_ESTOPPED) return;
    tvi_gather_member(ensemble->n, ensemble->member_count, segment->q, member, worker->member_q);
    tvi_gather_member(ensemble->n, ensemble->member_count, segment->p, member, worker->member_p);
    tvi_worker_load_member(worker, ensemble, member);
    if (ensemble->failure_status[member] != TVI_OK &&
        tvi_integrator_state_equals(worker->single_integrator, segment->t[member], worker->member_q,
                                    worker->member_p)) {
        segment->member_status[member] = ensemble->failure_status[member];
        return;
    }
    const tvi_member_run run = {.plan = &segment->plan,
                                .run_mode = segment->run_mode,
                                .member_index = member,
                                .member_count = ensemble->member_count,
                                .step_count_before_segment = segment->step_count_before_segment,
                                .observer_lock = &segment->ensemble->observer_lock};
    set_member_status(
        segment, member,
        tvi_run_member(worker->single_integrator, &run, &segment->t[member], worker->member_q, worker->member_p));
    tvi_scatter_member(ensemble->n, ensemble->member_count, worker->member_q, member, segment->q);
    tvi_scatter_member(ensemble->n, ensemble->member_count, worker->member_p, member, segment->p);
    tvi_worker_store_member(worker, ensemble, member);
}

/* ---- A batch of members ------------------------------------------------------------------------------------------ */

/* Loads the user's state of a member into a lane of the batch integrator. A member that has failed before and still has
 * the same state is not stepped: the function returns the status of that failure. */
static tvi_status load_member_state(const run_between_observer_calls *segment, tvi_integrator *it, int lane, int member)
{
    const tvi_user_state user_state = {segment->q + member, segment->p + member,
                                       (size_t)segment->ensemble->member_count, segment->t[member]};
    const tvi_status failed = segment->ensemble->failure_status[member];
    if (failed != TVI_OK && tvi_member_state_equals(it, lane, &user_state)) return failed;
    return tvi_member_begin_step(it, lane, &user_state);
}

/* Copies the state of the first lane to a lane that has no member, so that its numbers are finite. The lane is marked
 * as one that is not stepped. */
static void fill_unused_lane(tvi_integrator *it, int lane)
{
    for (int i = 0; i <= it->stepped->n; i++) it->state.q[i * it->width + lane] = it->state.q[i * it->width];
    for (int i = 0; i < it->stepped->n; i++) it->state.p[i * it->width + lane] = it->state.p[i * it->width];
    it->status[lane] = TVI_EINVAL;
}

static void step_members_together(const run_between_observer_calls *segment, tvi_integrator *it, int first_member,
                                  int member_count)
{
    const size_t members = (size_t)segment->ensemble->member_count;
    tvi_status *begun = segment->member_status + first_member;
    for (int lane = 0; lane < member_count; lane++)
        begun[lane] = it->status[lane] = load_member_state(segment, it, lane, first_member + lane);
    for (int lane = member_count; lane < it->width; lane++) fill_unused_lane(it, lane);
    tvi_make_steps_of_batch(it, segment->plan.steps, segment->plan.h);
    for (int lane = 0; lane < member_count; lane++) {
        const int at = first_member + lane;
        if (begun[lane] == TVI_OK)
            tvi_member_copy_state(it, lane, &segment->t[at], segment->q + at, segment->p + at, members);
        set_member_status(segment, at, it->status[lane]);
    }
}

static void run_batch_in_thread(void *ctx, int thread, int batch)
{
    const run_between_observer_calls *segment = ctx;
    tvi_ensemble_worker *worker = &segment->ensemble->workers[thread];
    const int first_member = tvi_first_member_of_batch(segment->ensemble, batch),
              member_count = tvi_count_members_of_batch(segment->ensemble, batch);
    tvi_worker_load_batch(worker, segment->ensemble, batch);
    if (worker->batch_integrator->width > 1 && segment->steps_members_together)
        step_members_together(segment, worker->batch_integrator, first_member, member_count);
    else
        for (int member = first_member; member < first_member + member_count; member++)
            run_single_member(segment, worker, member);
    tvi_worker_store_batch(worker, segment->ensemble, batch);
}

/* ---- The run ----------------------------------------------------------------------------------------------------- */

static tvi_status run_all_batches(const run_between_observer_calls *segment)
{
    const tvi_ensemble *ensemble = segment->ensemble;
    tvi_status status = TVI_OK;
    segment->ensemble->is_running = true;
    tvi_parallel_for(ensemble->thread_count, ensemble->batch_count, run_batch_in_thread, (void *)segment);
    segment->ensemble->is_running = false;
    for (int member = 0; member < ensemble->member_count; member++)
        if (segment->member_status[member] == TVI_ENOMEM) status = jet_explain_out_of_memory(TVI_ENOMEM);
    segment->ensemble->has_run = true;
    return status;
}

/* Makes all steps of the run. With an observer of the ensemble each step is a segment, after which the observer is
 * called. Without an observer all steps are one segment. */
static tvi_status run_all_segments(run_between_observer_calls *segment)
{
    const long steps = segment->plan.steps;
    tvi_ensemble_observer *observer = segment->plan.observer;
    if (!observer || steps == 0) return run_all_batches(segment);
    segment->plan.steps = 1;
    for (long step = 1; step <= steps; step++) {
        segment->step_count_before_segment = step - 1;
        const tvi_status status = run_all_batches(segment);
        if (status != TVI_OK) return status;
        if (observer(step, segment->ensemble->member_count, segment->t, segment->q, segment->p, segment->member_status,
                     segment->plan.ctx) != 0)
            return TVI_ESTOPPED;
    }
    return TVI_OK;
}

/* Allocates the memory for the tangent vectors in the integrators of all threads. */
static tvi_status allocate_tangent_columns(const tvi_ensemble *ensemble, int column_count)
{
    tvi_status status = TVI_OK;
    for (int i = 0; i < ensemble->thread_count && column_count > 0 && status == TVI_OK; i++)
        status = tvi_integrator_allocate_tangents(ensemble->workers[i].single_integrator, column_count);
    return status;
}

static tvi_status refuse_null_arguments(const tvi_ensemble *ensemble, const double t[], const double q[],
                                        const double p[], const tvi_status status[])
{
    return tvi_refuse_first_null_pointer(5, (const void *const[]){ensemble, t, q, p, status},
                                         (const char *const[]){"ensemble", "t", "q", "p", "status"});
}

tvi_status tvi_ensemble_run(tvi_ensemble *ensemble, const tvi_ensemble_plan *plan, double t[], double q[], double p[],
                            tvi_status status[])
{
    if (!ensemble || !t || !q || !p || !status) return refuse_null_arguments(ensemble, t, q, p, status);
    tvi_status checked = tvi_ensemble_refuse_if_running(ensemble);
    if (checked == TVI_OK) checked = tvi_plan_check(ensemble->workers->single_integrator, plan);
    if (checked != TVI_OK) return checked;
    const tvi_status provided = allocate_tangent_columns(ensemble, plan->columns);
    if (provided != TVI_OK) return provided;
    const bool steps_members_together =
        plan->steps > 0 && plan->event_count == 0 && plan->columns == 0 && !plan->at_step;
    run_between_observer_calls segment = {ensemble, *plan, tvi_plan_mode(plan), steps_members_together, 0, t, q,
                                          p,        status};
    return segment.run_mode == TVI_RUN_STEPS ? run_all_segments(&segment) : run_all_batches(&segment);
}

tvi_status tvi_ensemble_integrate(tvi_ensemble *ensemble, double h, long steps, double t[], double q[], double p[],
                                  tvi_status status[], tvi_ensemble_observer *observer, void *ctx)
{
    if (!ensemble || !t || !q || !p || !status) return refuse_null_arguments(ensemble, t, q, p, status);
    if (h == 0 || !isfinite(h)) return jet_refuse(TVI_EINVAL, "h is 0 or not finite");
    if (steps < 0) return jet_refuse(TVI_EINVAL, "steps is negative");
    const tvi_status idle = tvi_ensemble_refuse_if_running(ensemble);
    if (idle != TVI_OK) return idle;
    const tvi_run_plan plan = {.h = h, .steps = steps, .observer = observer, .ctx = ctx};
    run_between_observer_calls segment = {ensemble, plan, TVI_RUN_STEPS, true, 0, t, q, p, status};
    return run_all_segments(&segment);
}
