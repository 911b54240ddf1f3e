/* ensemble.c - Creates and frees ensembles, gives and takes the states of their members, and copies members between the
 * ensemble's memory and the integrators of its threads (tvi_worker_load_member, tvi_worker_store_member). A thread has
 * one integrator, which is a member from its load to its store. So a member's steps are those of an integrator of its
 * own, to the bit. */
#include "run/ensemble.h"
#include "system/refuse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t count_parameters_of_all_members(const tvi_ensemble *ensemble)
{
    return (size_t)tvi_system_parameters(ensemble->system) * (size_t)ensemble->member_count;
}

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

/* Creates the integrator of one thread. The first one is created from the options; all others copy its system and
 * options. */
static tvi_status create_worker(tvi_ensemble_worker *worker, const tvi_ensemble *ensemble, const tvi_options *options)
{
    const tvi_status status = worker == ensemble->workers
                                  ? tvi_integrator_create(&worker->integrator, ensemble->system, options)
                                  : tvi_integrator_create_like(&worker->integrator, ensemble->workers->integrator);
    if (status != TVI_OK) return status;
    worker->member_q = calloc(2 * (size_t)ensemble->n, sizeof *worker->member_q);
    if (!worker->member_q) return TVI_ENOMEM;
    worker->member_p = worker->member_q + ensemble->n;
    return TVI_OK;
}

static tvi_status allocate_member_memory(tvi_ensemble *ensemble)
{
    const tvi_integrator *it = ensemble->workers->integrator;
    const size_t members = (size_t)ensemble->member_count, numbers = count_parameters_of_all_members(ensemble);
    ensemble->history_bytes = it->history.bytes + tvi_arena_round_up(it->history.copied_bytes, ARENA_ALIGNMENT);
    ensemble->histories = aligned_alloc(ARENA_ALIGNMENT, members * ensemble->history_bytes);
    ensemble->records = calloc(members, sizeof *ensemble->records);
    ensemble->parameters = calloc(numbers + 1, sizeof *ensemble->parameters);
    ensemble->columns = calloc(members, sizeof *ensemble->columns);
    ensemble->stops = calloc(members, tvi_stop_bytes(ensemble->n));
    ensemble->failure_status = calloc(members, sizeof *ensemble->failure_status);
    if (!ensemble->histories || !ensemble->records || !ensemble->parameters || !ensemble->columns || !ensemble->stops ||
        !ensemble->failure_status)
        return TVI_ENOMEM;
    memset(ensemble->histories, 0, members * ensemble->history_bytes);
    for (size_t i = 0; i < numbers; i++) ensemble->parameters[i] = it->parameters[i / members];
    return TVI_OK;
}

static tvi_status create_workers_and_members(tvi_ensemble *ensemble, const tvi_options *options)
{
    tvi_status status = TVI_OK;
    ensemble->workers = calloc((size_t)ensemble->thread_count, sizeof *ensemble->workers);
    ensemble->team.started = calloc((size_t)ensemble->thread_count, sizeof *ensemble->team.started);
    ensemble->team.thread_count = ensemble->thread_count;
    if (!ensemble->workers || !ensemble->team.started) return TVI_ENOMEM;
    for (int i = 0; i < ensemble->thread_count && status == TVI_OK; i++)
        status = create_worker(&ensemble->workers[i], ensemble, options);
    return status == TVI_OK ? allocate_member_memory(ensemble) : status;
}

tvi_status tvi_ensemble_create(tvi_ensemble **out, const tvi_system *system, const tvi_options *options, int members,
                               int threads)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (!system) return jet_refuse(TVI_EINVAL, "system is NULL");
    if (members < 1) return jet_refuse(TVI_EINVAL, "members = %d is not positive", members);
    if (threads < 0) return jet_refuse(TVI_EINVAL, "threads = %d is negative", threads);
    tvi_ensemble *ensemble = calloc(1, sizeof *ensemble);
    if (!ensemble) return jet_explain_out_of_memory(TVI_ENOMEM);
    const int wanted = threads > 0 ? threads : tvi_parallel_thread_count();
    *ensemble = (tvi_ensemble){.system = system, .n = system->n, .member_count = members};
    ensemble->thread_count = wanted < members ? wanted : members;
    (void)pthread_mutex_init(&ensemble->observer_lock, NULL);
    const tvi_status status = create_workers_and_members(ensemble, options);
    if (status == TVI_OK) *out = ensemble;
    else tvi_ensemble_free(ensemble);
    return status == TVI_ENOMEM ? jet_explain_out_of_memory(status) : status;
}

void tvi_ensemble_free(tvi_ensemble *ensemble)
{
    if (!ensemble) return;
    if (ensemble->is_running) { /* longjmp has left an observer, which holds the lock that other threads wait for. */
        tvi_parallel_cancel(&ensemble->team);
        (void)pthread_mutex_unlock(&ensemble->observer_lock);
    }
    tvi_parallel_end(&ensemble->team);
    free(ensemble->team.started);
    for (int i = 0; ensemble->workers && i < ensemble->thread_count; i++) {
        tvi_integrator_free(ensemble->workers[i].integrator);
        free(ensemble->workers[i].member_q);
    }
    for (int m = 0; ensemble->columns && m < ensemble->member_count; m++) tvi_step_columns_free(&ensemble->columns[m]);
    free(ensemble->workers);
    free(ensemble->histories);
    free(ensemble->records);
    free(ensemble->parameters);
    free(ensemble->columns);
    free(ensemble->stops);
    free(ensemble->failure_status);
    (void)pthread_mutex_destroy(&ensemble->observer_lock);
    free(ensemble);
}

/* ---- Members ----------------------------------------------------------------------------------------------------- */

static char *history_of_member(const tvi_ensemble *ensemble, int member)
{
    return ensemble->histories + (size_t)member * ensemble->history_bytes;
}

/* Tells whether the last stop of a member is read or written; a run without events does neither. */
static bool needs_stops(const tvi_ensemble *ensemble)
{
    return !ensemble->is_running || ensemble->segment.plan.event_count > 0;
}

/* Tells whether the run of a member may continue inside its last step, whose curve a rescaled system needs for times
 * there. */
static bool needs_curve(const tvi_ensemble *ensemble, int member)
{
    return ensemble->is_running && ensemble->segment.plan.time_count > 0 &&
           ensemble->records[member].has_dense_output && tvi_is_rescaled(ensemble->workers->integrator);
}

/* The curve of a step is no part of the history. The same step, made once more from the same history, has the same
 * curve. */
void tvi_worker_load_member(tvi_ensemble_worker *worker, tvi_ensemble *ensemble, int member)
{
    tvi_integrator *it = worker->integrator;
    const tvi_member_record *record = &ensemble->records[member];
    const tvi_stats own = it->stats;
    tvi_arena_copy_history(it->history.now, history_of_member(ensemble, member), ensemble->history_bytes);
    tvi_integrator_load_parameters(it, ensemble->parameters + member, (size_t)ensemble->member_count);
    if (needs_curve(ensemble, member)) {
        tvi_arena_copy_history(it->history.now, it->history.before, it->history.copied_bytes);
        tvi_integrator_compute_curve(it, record->h);
        tvi_arena_copy_history(it->history.now, history_of_member(ensemble, member), ensemble->history_bytes);
    }
    if (needs_stops(ensemble)) memcpy(it->stop, tvi_stop_of_member(ensemble, member), tvi_stop_bytes(ensemble->n));
    it->stats = record->stats;
    it->stats.bytes = own.bytes;
    it->stats.is_compiled = own.is_compiled;
    it->last_step.h = record->h;
    it->last_step.covered_time = record->covered_time;
    it->last_step.has_curve = record->has_dense_output;
    if (it->tangent) tvi_step_columns_exchange(it, &ensemble->columns[member]);
}

void tvi_worker_store_member(tvi_ensemble_worker *worker, tvi_ensemble *ensemble, int member)
{
    tvi_integrator *it = worker->integrator;
    tvi_member_record *record = &ensemble->records[member];
    tvi_arena_copy_history(history_of_member(ensemble, member), it->history.now, ensemble->history_bytes);
    tvi_scatter_member(tvi_system_parameters(it->system), ensemble->member_count, it->parameters, member,
                       ensemble->parameters);
    if (needs_stops(ensemble)) memcpy(tvi_stop_of_member(ensemble, member), it->stop, tvi_stop_bytes(ensemble->n));
    *record = (tvi_member_record){it->stats, it->last_step.h, it->last_step.covered_time, it->last_step.has_curve};
    record->stats.bytes = 0;
    if (it->tangent) tvi_step_columns_exchange(it, &ensemble->columns[member]);
}

/* ---- Calls for all members --------------------------------------------------------------------------------------- */

tvi_status tvi_ensemble_set_parameters(tvi_ensemble *ensemble, const double value[])
{
    if (!ensemble || !value)
        return tvi_refuse_first_null_pointer(2, (const void *const[]){ensemble, value},
                                             (const char *const[]){"ensemble", "value"});
    for (size_t i = 0; i < count_parameters_of_all_members(ensemble); i++)
        if (!isfinite(value[i])) return jet_refuse(TVI_ENONFINITE, "value[%zu] is not finite", i);
    const tvi_status idle = tvi_ensemble_refuse_if_running(ensemble);
    if (idle != TVI_OK) return idle;
    memmove(ensemble->parameters, value, count_parameters_of_all_members(ensemble) * sizeof *value);
    /* The events of the stops were computed with the old parameters, so the next run must report them again. */
    for (int member = 0; member < ensemble->member_count; member++)
        tvi_event_stop_clear(tvi_stop_of_member(ensemble, member), ensemble->n);
    tvi_ensemble_reset(ensemble);
    return TVI_OK;
}

void tvi_ensemble_reset(tvi_ensemble *ensemble)
{
    if (!ensemble || tvi_ensemble_refuse_if_running(ensemble) != TVI_OK) return;
    const size_t members = (size_t)ensemble->member_count;
    memset(ensemble->histories, 0, members * ensemble->history_bytes);
    memset(ensemble->failure_status, 0, members * sizeof *ensemble->failure_status);
    for (size_t m = 0; m < members; m++) {
        ensemble->records[m].stats.largest_tail = ensemble->records[m].stats.largest_defect = 0;
        ensemble->records[m].has_dense_output = false;
    }
    ensemble->has_run = false;
}

static void add_step_counts(tvi_stats *sum, const tvi_stats *stats)
{
    sum->steps += stats->steps;
    sum->passes += stats->passes;
    sum->expansions += stats->expansions;
    sum->force_evaluations += stats->force_evaluations;
    sum->factorisations += stats->factorisations;
    sum->largest_tail = fmax(sum->largest_tail, stats->largest_tail);
    sum->largest_defect = fmax(sum->largest_defect, stats->largest_defect);
}

tvi_status tvi_ensemble_stats(const tvi_ensemble *ensemble, tvi_stats *stats)
{
    if (!ensemble || !stats)
        return tvi_refuse_first_null_pointer(2, (const void *const[]){ensemble, stats},
                                             (const char *const[]){"ensemble", "stats"});
    const tvi_status idle = tvi_ensemble_refuse_if_running(ensemble);
    if (idle != TVI_OK) return idle;
    const size_t members = (size_t)ensemble->member_count;
    *stats = (tvi_stats){.is_compiled = ensemble->workers->integrator->stats.is_compiled};
    for (size_t m = 0; m < members; m++) add_step_counts(stats, &ensemble->records[m].stats);
    stats->bytes = sizeof *ensemble + count_parameters_of_all_members(ensemble) * sizeof *ensemble->parameters +
                   members * (ensemble->history_bytes + sizeof *ensemble->records + sizeof *ensemble->columns +
                              sizeof *ensemble->failure_status + tvi_stop_bytes(ensemble->n));
    for (int i = 0; i < ensemble->thread_count; i++) stats->bytes += ensemble->workers[i].integrator->stats.bytes;
    return TVI_OK;
}

/* ---- States of members ------------------------------------------------------------------------------------------- */

tvi_status tvi_ensemble_last(const tvi_ensemble *ensemble, double t[], double q[], double p[], tvi_status status[])
{
    if (!ensemble || !t || !q || !p || !status)
        return tvi_refuse_first_null_pointer(5, (const void *const[]){ensemble, t, q, p, status},
                                             (const char *const[]){"ensemble", "t", "q", "p", "status"});
    const tvi_status idle = tvi_ensemble_refuse_if_running(ensemble);
    if (idle != TVI_OK) return idle;
    if (!ensemble->has_run)
        return jet_refuse(TVI_EINVAL,
                          "the ensemble has made no run, and no member was loaded, since it was created or reset");
    tvi_ensemble_worker *worker = ensemble->workers;
    for (int m = 0; m < ensemble->member_count; m++) {
        tvi_worker_load_member(worker, (tvi_ensemble *)ensemble, m);
        tvi_integrator_copy_state(worker->integrator, &t[m], worker->member_q, worker->member_p);
        tvi_scatter_member(ensemble->n, ensemble->member_count, worker->member_q, m, q);
        tvi_scatter_member(ensemble->n, ensemble->member_count, worker->member_p, m, p);
        status[m] = ensemble->failure_status[m];
        tvi_worker_store_member(worker, (tvi_ensemble *)ensemble, m);
    }
    return TVI_OK;
}

static tvi_status check_member_arguments(const tvi_ensemble *ensemble, int member, const void *const pointers[4],
                                         const char *last_pointer_name)
{
    const void *const all[] = {ensemble, pointers[0], pointers[1], pointers[2], pointers[3]};
    for (int i = 0; i < 5; i++)
        if (!all[i])
            return tvi_refuse_first_null_pointer(5, all,
                                                 (const char *const[]){"ensemble", "t", "q", "p", last_pointer_name});
    if (member < 0 || member >= ensemble->member_count)
        return jet_refuse(TVI_EINVAL, "member = %d is not from 0 to %d", member, ensemble->member_count - 1);
    return tvi_ensemble_refuse_if_running(ensemble);
}

tvi_status tvi_ensemble_member_to_text(const tvi_ensemble *ensemble, int member, const double t[], const double q[],
                                       const double p[], char *text, size_t *size)
{
    tvi_status status = check_member_arguments(ensemble, member, (const void *const[]){t, q, p, size}, "size");
    if (status != TVI_OK) return status;
    tvi_ensemble_worker *worker = ensemble->workers;
    tvi_worker_load_member(worker, (tvi_ensemble *)ensemble, member);
    tvi_gather_member(ensemble->n, ensemble->member_count, q, member, worker->member_q);
    tvi_gather_member(ensemble->n, ensemble->member_count, p, member, worker->member_p);
    status = tvi_state_to_text(worker->integrator, t[member], worker->member_q, worker->member_p, text, size);
    tvi_worker_store_member(worker, (tvi_ensemble *)ensemble, member);
    return status;
}

tvi_status tvi_ensemble_member_from_text(tvi_ensemble *ensemble, int member, const char *text, size_t size, double t[],
                                         double q[], double p[])
{
    tvi_status status = check_member_arguments(ensemble, member, (const void *const[]){t, q, p, text}, "text");
    if (status != TVI_OK) return status;
    tvi_ensemble_worker *worker = ensemble->workers;
    tvi_worker_load_member(worker, ensemble, member);
    status = tvi_state_from_text(worker->integrator, text, size, &t[member], worker->member_q, worker->member_p);
    if (status == TVI_OK) {
        tvi_scatter_member(ensemble->n, ensemble->member_count, worker->member_q, member, q);
        tvi_scatter_member(ensemble->n, ensemble->member_count, worker->member_p, member, p);
        ensemble->failure_status[member] = TVI_OK;
        ensemble->has_run = true;
    }
    tvi_worker_store_member(worker, ensemble, member);
    return status;
}
