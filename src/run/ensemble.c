/* ensemble.c - Creates, frees, saves and loads ensembles, and copies members between the ensemble's memory and the
 * integrators of its threads (tvi_worker_load_member, tvi_worker_store_member). A thread has one integrator, which is a
 * member from its load to its store. So a member's steps are those of an integrator of its own, to the bit. */
#include "run/ensemble.h"
#include "integrator/saved.h"
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
    ensemble->history_bytes = it->history_bytes + tvi_arena_round_up(it->copied_history_bytes, ARENA_ALIGNMENT);
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

void tvi_worker_load_member(tvi_ensemble_worker *worker, tvi_ensemble *ensemble, int member)
{
    tvi_integrator *it = worker->integrator;
    const tvi_member_record *record = &ensemble->records[member];
    const tvi_stats own = it->stats;
    tvi_arena_copy_history(it->history, history_of_member(ensemble, member), ensemble->history_bytes);
    tvi_integrator_load_parameters(it, ensemble->parameters + member, (size_t)ensemble->member_count);
    if (needs_stops(ensemble)) memcpy(it->stop, tvi_stop_of_member(ensemble, member), tvi_stop_bytes(ensemble->n));
    it->stats = record->stats;
    it->stats.bytes = own.bytes;
    it->stats.is_compiled = own.is_compiled;
    it->h = record->h;
    it->covered_time = record->covered_time;
    it->has_dense_output = record->has_dense_output;
    if (it->tangent) tvi_step_columns_exchange(it, &ensemble->columns[member]);
}

void tvi_worker_store_member(tvi_ensemble_worker *worker, tvi_ensemble *ensemble, int member)
{
    tvi_integrator *it = worker->integrator;
    tvi_member_record *record = &ensemble->records[member];
    tvi_arena_copy_history(history_of_member(ensemble, member), it->history, ensemble->history_bytes);
    tvi_scatter_member(tvi_system_parameters(it->system), ensemble->member_count, it->parameters, member,
                       ensemble->parameters);
    if (needs_stops(ensemble)) memcpy(tvi_stop_of_member(ensemble, member), it->stop, tvi_stop_bytes(ensemble->n));
    *record = (tvi_member_record){it->stats, it->h, it->covered_time, it->has_dense_output};
    record->stats.bytes = 0;
    if (it->tangent) tvi_step_columns_exchange(it, &ensemble->columns[member]);
}

/* The curve of a step is no part of the history, and a rescaled system needs it for times inside the step. The same
 * step, made once more from the same history, has the same curve. */
void tvi_worker_load_member_and_curve(tvi_ensemble_worker *worker, tvi_ensemble *ensemble, int member)
{
    tvi_integrator *it = worker->integrator;
    if (ensemble->records[member].has_dense_output && tvi_is_rescaled(it)) {
        tvi_arena_copy_history(it->history, history_of_member(ensemble, member), ensemble->history_bytes);
        tvi_arena_copy_history(it->history, it->history_before, it->copied_history_bytes);
        tvi_integrator_load_parameters(it, ensemble->parameters + member, (size_t)ensemble->member_count);
        tvi_integrator_compute_curve(it, ensemble->records[member].h);
    }
    tvi_worker_load_member(worker, ensemble, member);
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

/* ---- Saved states ------------------------------------------------------------------------------------------------ */

/* The indices of the pieces of a saved ensemble. The bytes are: identity | counts (tvi_stats) | statuses |
 * parameters | stops | histories | checksum. */
enum { COUNTS, STATUSES, PARAMETERS, STOPS, HISTORIES };

static void list_saved_pieces(const tvi_ensemble *ensemble, tvi_stats *stats, tvi_saved_pieces *pieces)
{
    const size_t members = (size_t)ensemble->member_count;
    pieces->piece_count = 0;
    tvi_saved_pieces_add(pieces, stats, sizeof *stats);
    tvi_saved_pieces_add(pieces, ensemble->failure_status, members * sizeof *ensemble->failure_status);
    tvi_saved_pieces_add(pieces, ensemble->parameters,
                         count_parameters_of_all_members(ensemble) * sizeof *ensemble->parameters);
    tvi_saved_pieces_add(pieces, ensemble->stops, members * tvi_stop_bytes(ensemble->n));
    tvi_saved_pieces_add(pieces, ensemble->histories, members * ensemble->history_bytes);
}

static tvi_saved_identity compute_ensemble_identity(const tvi_ensemble *ensemble, const tvi_saved_pieces *pieces)
{
    tvi_saved_identity who =
        tvi_saved_identity_of_integrator(ensemble->workers->integrator, tvi_saved_size_in_bytes(pieces));
    who.has_stepped = ensemble->has_run;
    who.member_count = ensemble->member_count;
    return who;
}

tvi_status tvi_ensemble_save(const tvi_ensemble *ensemble, void *buffer, size_t *size)
{
    if (!ensemble || !size) return jet_refuse(TVI_EINVAL, "%s is NULL", ensemble ? "size" : "ensemble");
    tvi_stats stats;
    tvi_saved_pieces pieces;
    tvi_status status = tvi_ensemble_refuse_if_running(ensemble);
    if (status == TVI_OK) status = tvi_ensemble_stats(ensemble, &stats);
    if (status != TVI_OK) return status;
    list_saved_pieces(ensemble, &stats, &pieces);
    const tvi_saved_identity own = compute_ensemble_identity(ensemble, &pieces);
    return tvi_saved_write(&own, &pieces, buffer, size);
}

/* Tells whether the loaded pieces are valid, so that a run can go on from them. */
static bool are_saved_pieces_valid(tvi_ensemble *ensemble, const tvi_saved_pieces *pieces, const void *buffer)
{
    const char *histories = tvi_saved_piece_address(pieces, HISTORIES, buffer);
    tvi_integrator *it = ensemble->workers->integrator;
    if (!tvi_saved_stats_are_valid(tvi_saved_piece_address(pieces, COUNTS, buffer)) ||
        !tvi_saved_stops_are_valid(tvi_saved_piece_address(pieces, STOPS, buffer), ensemble->n,
                                   ensemble->member_count) ||
        !tvi_numbers_are_finite(tvi_saved_piece_address(pieces, PARAMETERS, buffer), pieces->piece[PARAMETERS].bytes))
        return false;
    for (size_t m = 0; m < (size_t)ensemble->member_count; m++) {
        tvi_status status;
        memcpy(&status, tvi_saved_piece_address(pieces, STATUSES, buffer) + m * sizeof status, sizeof status);
        if (status != TVI_OK && !tvi_is_failure_of_member(status)) return false;
        tvi_arena_copy_history(it->history, histories + m * ensemble->history_bytes, ensemble->history_bytes);
        if (!tvi_loaded_history_is_valid(it)) return false;
    }
    return true;
}

tvi_status tvi_ensemble_load(tvi_ensemble *ensemble, const void *buffer, size_t size)
{
    if (!ensemble || !buffer) return jet_refuse(TVI_EINVAL, "%s is NULL", ensemble ? "buffer" : "ensemble");
    tvi_stats stats;
    tvi_saved_pieces pieces;
    tvi_saved_identity who;
    const tvi_status idle = tvi_ensemble_refuse_if_running(ensemble);
    if (idle != TVI_OK) return idle;
    list_saved_pieces(ensemble, &stats, &pieces);
    const tvi_saved_identity own = compute_ensemble_identity(ensemble, &pieces);
    const char *const mismatch = tvi_saved_find_mismatch(&own, buffer, size);
    if (mismatch) return jet_refuse(TVI_EINVAL, "%s", mismatch);
    if (!are_saved_pieces_valid(ensemble, &pieces, buffer)) return jet_refuse(TVI_EINVAL, "the state is damaged");
    memcpy(&who, buffer, sizeof who);
    for (int i = 0; i < pieces.piece_count; i++) tvi_saved_load_piece(&pieces, i, buffer);
    memset(ensemble->records, 0, (size_t)ensemble->member_count * sizeof *ensemble->records);
    ensemble->records->stats = stats; /* The counts of all members together are those of the first one from here on. */
    ensemble->has_run = who.has_stepped != 0;
    return TVI_OK;
}

tvi_status tvi_ensemble_last(const tvi_ensemble *ensemble, double t[], double q[], double p[], tvi_status status[])
{
    if (!ensemble || !t || !q || !p || !status)
        return tvi_refuse_first_null_pointer(5, (const void *const[]){ensemble, t, q, p, status},
                                             (const char *const[]){"ensemble", "t", "q", "p", "status"});
    const tvi_status idle = tvi_ensemble_refuse_if_running(ensemble);
    if (idle != TVI_OK) return idle;
    if (!ensemble->has_run) return jet_refuse(TVI_EINVAL, "the ensemble has made no run, or was reset");
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
