/* ensemble.c - Creates and frees ensembles, saves and loads them, and moves members between the ensemble's memory and
 * the integrators of its threads. The memory of a batch between two steps is an integrator's history (arena.h),
 * together with the parameters and the stops of its members. */
#include "run/ensemble.h"
#include "run/saved.h"
#include "run/parallel_for.h"
#include "system/refuse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t parameter_count(const tvi_ensemble *e)
{
    return (size_t)tvi_system_parameters(e->system) * (size_t)e->members;
}

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

/* The first worker's integrator is created from the options; the other workers' integrators are like it. */
static tvi_status make_worker(tvi_worker *w, const tvi_ensemble *e, const tvi_options *options)
{
    tvi_status status = w == e->worker ? tvi_integrator_create(&w->single, e->system, options)
                                       : tvi_integrator_create_like(&w->single, e->worker->single, 1);
    if (status != TVI_OK) return status;
    w->q = calloc(2 * (size_t)e->n, sizeof *w->q);
    if (!w->q) return TVI_ENOMEM;
    w->p = w->q + e->n;
    const int width = tvi_integrator_width(w->single);
    w->batch = w->single;
    return width > 1 ? tvi_integrator_create_like(&w->batch, w->single, width) : TVI_OK;
}

static tvi_status make_members(tvi_ensemble *e)
{
    const tvi_integrator *batch = e->worker->batch;
    e->width = batch->width;
    e->batches = (e->members - 1) / e->width + 1;
    e->history_bytes = batch->history_bytes;
    e->memory = aligned_alloc(ARENA_ALIGNMENT, (size_t)e->batches * e->history_bytes);
    e->parameters = calloc(parameter_count(e) + 1, sizeof *e->parameters);
    e->stops = calloc((size_t)e->members, tvi_stop_bytes(e->n));
    e->failed = calloc((size_t)e->members, sizeof *e->failed);
    if (!e->memory || !e->parameters || !e->stops || !e->failed) return TVI_ENOMEM;
    memset(e->memory, 0, (size_t)e->batches * e->history_bytes);
    for (size_t i = 0; i < parameter_count(e); i++)
        e->parameters[i] = e->worker->single->parameters[i / (size_t)e->members];
    return TVI_OK;
}

static tvi_status make(tvi_ensemble *e, const tvi_options *options)
{
    tvi_status status = TVI_OK;
    e->worker = calloc((size_t)e->threads, sizeof *e->worker);
    if (!e->worker) return TVI_ENOMEM;
    for (int i = 0; i < e->threads && status == TVI_OK; i++) status = make_worker(&e->worker[i], e, options);
    return status == TVI_OK ? make_members(e) : status;
}

tvi_status tvi_ensemble_create(tvi_ensemble **out, const tvi_system *system, const tvi_options *options, int members,
                               int threads)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (!system) return jet_refuse(TVI_EINVAL, "system is NULL");
    if (members < 1) return jet_refuse(TVI_EINVAL, "members = %d is not positive", members);
    if (threads < 0) return jet_refuse(TVI_EINVAL, "threads = %d is negative", threads);
    tvi_ensemble *e = calloc(1, sizeof *e);
    if (!e) return jet_refuse_memory(TVI_ENOMEM);
    const int wanted = threads > 0 ? threads : tvi_parallel_threads();
    if (!tvi_parallel_can_start(wanted < members ? wanted : members)) {
        free(e);
        return jet_refuse(TVI_ENOMEM, "so many threads cannot be started");
    }
    *e = (tvi_ensemble){.system = system, .n = system->n, .members = members};
    e->threads = wanted < members ? wanted : members;
    (void)pthread_mutex_init(&e->observer_lock, NULL);
    const tvi_status status = make(e, options);
    if (status == TVI_OK) *out = e;
    else tvi_ensemble_free(e);
    return status == TVI_ENOMEM ? jet_refuse_memory(status) : status;
}

void tvi_ensemble_free(tvi_ensemble *e)
{
    if (!e) return;
    for (int i = 0; e->worker && i < e->threads; i++) {
        if (e->worker[i].batch != e->worker[i].single) tvi_integrator_free(e->worker[i].batch);
        tvi_integrator_free(e->worker[i].single);
        free(e->worker[i].q);
    }
    free(e->worker);
    free(e->memory);
    free(e->parameters);
    free(e->stops);
    free(e->failed);
    (void)pthread_mutex_destroy(&e->observer_lock);
    free(e);
}

/* ---- Members ----------------------------------------------------------------------------------------------------- */

static char *memory_of(const tvi_ensemble *e, int batch) { return e->memory + (size_t)batch * e->history_bytes; }

static char *stop_of(const tvi_ensemble *e, int member) { return e->stops + (size_t)member * tvi_stop_bytes(e->n); }

void tvi_worker_load(tvi_worker *w, const tvi_ensemble *e, int batch)
{
    tvi_arena_copy(w->batch->history, memory_of(e, batch), e->history_bytes);
    tvi_integrator_load_parameters(w->batch, e->parameters + tvi_first_member(e, batch), (size_t)e->members,
                                   tvi_members_of(e, batch));
    w->batch->has_dense = false;
}

void tvi_worker_store(const tvi_worker *w, tvi_ensemble *e, int batch)
{
    tvi_arena_copy(memory_of(e, batch), w->batch->history, e->history_bytes);
}

void tvi_worker_load_member(tvi_worker *w, const tvi_ensemble *e, int member)
{
    if (w->batch != w->single) {
        tvi_member_copy(w->single, 0, w->batch, member % e->width);
        tvi_integrator_load_parameters(w->single, e->parameters + member, (size_t)e->members, 1);
    }
    memcpy(w->single->stop, stop_of(e, member), tvi_stop_bytes(e->n));
}

void tvi_worker_store_member(tvi_worker *w, const tvi_ensemble *e, int member)
{
    if (w->batch != w->single) tvi_member_copy(w->batch, member % e->width, w->single, 0);
    memcpy(stop_of(e, member), w->single->stop, tvi_stop_bytes(e->n));
}

/* ---- What is asked of all ---------------------------------------------------------------------------------------- */

tvi_status tvi_ensemble_set_parameters(tvi_ensemble *e, const double value[])
{
    if (!e || !value)
        return tvi_refuse_null(2, (const void *const[]){e, value}, (const char *const[]){"ensemble", "value"});
    for (size_t i = 0; i < parameter_count(e); i++)
        if (!isfinite(value[i])) return jet_refuse(TVI_ENONFINITE, "value[%zu] is not finite", i);
    const tvi_status idle = tvi_ensemble_check_idle(e);
    if (idle != TVI_OK) return idle;
    memmove(e->parameters, value, parameter_count(e) * sizeof *value);
    memset(e->stops, 0, (size_t)e->members * tvi_stop_bytes(e->n)); /* the events had other parameters */
    tvi_ensemble_reset(e);
    return TVI_OK;
}

void tvi_ensemble_reset(tvi_ensemble *e)
{
    if (!e) return;
    memset(e->memory, 0, (size_t)e->batches * e->history_bytes);
    memset(e->failed, 0, (size_t)e->members * sizeof *e->failed);
    for (int i = 0; i < e->threads; i++) {
        e->worker[i].single->stats.largest_tail = 0;
        e->worker[i].batch->stats.largest_tail = 0;
    }
    e->loaded.largest_tail = 0;
    e->has_run = false;
}

static void add_stats(tvi_stats *sum, const tvi_stats *stats)
{
    sum->steps += stats->steps;
    sum->passes += stats->passes;
    sum->expansions += stats->expansions;
    sum->force_evaluations += stats->force_evaluations;
    sum->factorisations += stats->factorisations;
    sum->largest_tail = fmax(sum->largest_tail, stats->largest_tail);
    sum->bytes += stats->bytes;
}

tvi_status tvi_ensemble_stats(const tvi_ensemble *e, tvi_stats *stats)
{
    if (!e || !stats)
        return tvi_refuse_null(2, (const void *const[]){e, stats}, (const char *const[]){"ensemble", "stats"});
    *stats = e->loaded;
    stats->bytes = sizeof *e + (size_t)e->batches * e->history_bytes + parameter_count(e) * sizeof *e->parameters +
                   (size_t)e->members * (sizeof *e->failed + tvi_stop_bytes(e->n));
    for (int i = 0; i < e->threads; i++) {
        add_stats(stats, &e->worker[i].single->stats);
        if (e->worker[i].batch != e->worker[i].single) add_stats(stats, &e->worker[i].batch->stats);
    }
    stats->is_compiled = e->worker->single->stats.is_compiled;
    return TVI_OK;
}

/* ---- Saved states ------------------------------------------------------------------------------------------------ */

/* The bytes of a saved ensemble: identity | counts | statuses | parameters | stops | histories | checksum. */
enum { COUNTS, STATUSES, PARAMETERS, STOPS, HISTORIES };

static void list_pieces(const tvi_ensemble *e, tvi_stats *stats, tvi_pieces *pieces)
{
    const size_t members = (size_t)e->members;
    pieces->count = 0;
    tvi_pieces_add(pieces, stats, sizeof *stats);
    tvi_pieces_add(pieces, e->failed, members * sizeof *e->failed);
    tvi_pieces_add(pieces, e->parameters, parameter_count(e) * sizeof *e->parameters);
    tvi_pieces_add(pieces, e->stops, members * tvi_stop_bytes(e->n));
    tvi_pieces_add(pieces, e->memory, (size_t)e->batches * e->history_bytes);
}

static tvi_identity identity_of(const tvi_ensemble *e, const tvi_pieces *pieces)
{
    tvi_identity who = tvi_identity_of(e->worker->single, tvi_saved_size(pieces));
    who.has_stepped = e->has_run;
    who.members = e->members;
    who.width = e->width;
    return who;
}

tvi_status tvi_ensemble_save(const tvi_ensemble *e, void *buffer, size_t *size)
{
    if (!e || !size) return jet_refuse(TVI_EINVAL, "%s is NULL", e ? "size" : "ensemble");
    tvi_stats stats;
    tvi_pieces pieces;
    tvi_status status = tvi_ensemble_check_idle(e);
    if (status == TVI_OK) status = tvi_ensemble_stats(e, &stats);
    if (status != TVI_OK) return status;
    list_pieces(e, &stats, &pieces);
    const tvi_identity own = identity_of(e, &pieces);
    return tvi_saved_write(&own, &pieces, buffer, size);
}

/* Tells whether a run can go on from the contents of the pieces. */
static bool are_sound(tvi_ensemble *e, const tvi_pieces *pieces, const void *buffer)
{
    const char *histories = tvi_saved_piece(pieces, HISTORIES, buffer);
    tvi_integrator *it = e->worker->batch;
    if (!tvi_stats_are_sound(tvi_saved_piece(pieces, COUNTS, buffer)) ||
        !tvi_stops_are_sound(tvi_saved_piece(pieces, STOPS, buffer), e->n, e->members) ||
        !tvi_numbers_are_finite(tvi_saved_piece(pieces, PARAMETERS, buffer), pieces->piece[PARAMETERS].bytes))
        return false;
    for (int m = 0; m < e->members; m++) {
        tvi_status status;
        memcpy(&status, tvi_saved_piece(pieces, STATUSES, buffer) + (size_t)m * sizeof status, sizeof status);
        if (status != TVI_OK && !tvi_status_is_of_member(status)) return false;
    }
    for (int batch = 0; batch < e->batches; batch++) {
        tvi_arena_copy(it->history, histories + (size_t)batch * e->history_bytes, e->history_bytes);
        if (!tvi_history_is_sound(it)) return false;
    }
    return true;
}

tvi_status tvi_ensemble_load(tvi_ensemble *e, const void *buffer, size_t size)
{
    if (!e || !buffer) return jet_refuse(TVI_EINVAL, "%s is NULL", e ? "buffer" : "ensemble");
    tvi_stats stats;
    tvi_pieces pieces;
    tvi_identity who;
    const tvi_status idle = tvi_ensemble_check_idle(e);
    if (idle != TVI_OK) return idle;
    list_pieces(e, &stats, &pieces);
    const tvi_identity own = identity_of(e, &pieces);
    const char *const misfit = tvi_saved_misfit(&own, buffer, size);
    if (misfit) return jet_refuse(TVI_EINVAL, "%s", misfit);
    if (!are_sound(e, &pieces, buffer)) return jet_refuse(TVI_EINVAL, "the state is damaged");
    memcpy(&who, buffer, sizeof who);
    for (int i = 0; i < pieces.count; i++) tvi_saved_read(&pieces, i, buffer);
    e->loaded = stats;
    for (int i = 0; i < e->threads; i++) {
        tvi_stats *const all[] = {&e->worker[i].single->stats, &e->worker[i].batch->stats};
        for (int k = 0; k < 2; k++) *all[k] = (tvi_stats){.bytes = all[k]->bytes, .is_compiled = all[k]->is_compiled};
    }
    e->has_run = who.has_stepped != 0;
    return TVI_OK;
}

tvi_status tvi_ensemble_last(const tvi_ensemble *e, double t[], double q[], double p[], tvi_status status[])
{
    if (!e || !t || !q || !p || !status)
        return tvi_refuse_null(5, (const void *const[]){e, t, q, p, status},
                               (const char *const[]){"ensemble", "t", "q", "p", "status"});
    const tvi_status idle = tvi_ensemble_check_idle(e);
    if (idle != TVI_OK) return idle;
    if (!e->has_run) return jet_refuse(TVI_EINVAL, "the ensemble has made no run, or was reset");
    tvi_worker *w = e->worker;
    for (int m = 0; m < e->members; m++) {
        if (m % e->width == 0) tvi_worker_load(w, e, m / e->width);
        tvi_member_copy_state(w->batch, m % e->width, &t[m], q + m, p + m, (size_t)e->members);
        status[m] = e->failed[m];
    }
    return TVI_OK;
}
