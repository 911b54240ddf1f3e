/* ensemble.c - many members, and the few integrators that take turns in stepping them: all that one member is between
 * two steps is an integrator's history (arena.h), or a lane of a crowd's. */
#include "run/ensemble.h"
#include "run/spread.h"
#include "system/refuse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t parameter_count(const tvi_ensemble *e)
{
    return (size_t)tvi_system_parameters(e->system) * (size_t)e->members;
}

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

/* The first worker's integrator is made by the options, the others are its twins. */
static tvi_status make_worker(tvi_worker *w, const tvi_ensemble *e, const tvi_options *options)
{
    const tvi_status status =
        w == e->worker ? tvi_integrator_create(&w->it, e->system, options) : tvi_integrator_twin(&w->it, e->worker->it);
    if (status != TVI_OK) return status;
    w->q = calloc(2 * (size_t)e->n, sizeof *w->q);
    if (!w->q) return TVI_ENOMEM;
    w->p = w->q + e->n;
    return tvi_crowd_create(&w->crowd, w->it);
}

static tvi_status make_members(tvi_ensemble *e)
{
    const tvi_crowd *crowd = e->worker->crowd;
    const tvi_integrator *it = e->worker->it;
    e->lanes = crowd ? crowd->width : 1;
    e->blocks = (e->members - 1) / e->lanes + 1;
    e->remembered = crowd ? crowd->remembered : it->remembered;
    e->memory = aligned_alloc(ARENA_ALIGNMENT, (size_t)e->blocks * e->remembered);
    e->parameters = calloc(parameter_count(e) + 1, sizeof *e->parameters);
    e->stops = calloc((size_t)e->members, tvi_stop_bytes(e->n));
    e->failed = calloc((size_t)e->members, sizeof *e->failed);
    if (!e->memory || !e->parameters || !e->stops || !e->failed) return TVI_ENOMEM;
    memset(e->memory, 0, (size_t)e->blocks * e->remembered);
    for (size_t i = 0; i < parameter_count(e); i++) e->parameters[i] = it->parameters[i / (size_t)e->members];
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
    const int wanted = threads > 0 ? threads : tvi_spread_threads();
    if (!tvi_spread_can_start(wanted < members ? wanted : members)) {
        free(e);
        return jet_refuse(TVI_ENOMEM, "so many threads cannot be started");
    }
    *e = (tvi_ensemble){.system = system, .n = system->n, .members = members};
    e->threads = wanted < members ? wanted : members;
    (void)pthread_mutex_init(&e->told, NULL);
    const tvi_status status = make(e, options);
    if (status == TVI_OK) *out = e;
    else tvi_ensemble_free(e);
    return status == TVI_ENOMEM ? jet_refuse_memory(status) : status;
}

void tvi_ensemble_free(tvi_ensemble *e)
{
    if (!e) return;
    for (int i = 0; e->worker && i < e->threads; i++) {
        tvi_crowd_free(e->worker[i].crowd);
        tvi_integrator_free(e->worker[i].it);
        free(e->worker[i].q);
        free(e->worker[i].D);
    }
    free(e->worker);
    free(e->memory);
    free(e->parameters);
    free(e->stops);
    free(e->failed);
    (void)pthread_mutex_destroy(&e->told);
    free(e);
}

/* ---- Members ----------------------------------------------------------------------------------------------------- */

static char *memory_of(const tvi_ensemble *e, int block) { return e->memory + (size_t)block * e->remembered; }

static char *stop_of(const tvi_ensemble *e, int member) { return e->stops + (size_t)member * tvi_stop_bytes(e->n); }

void tvi_worker_load(tvi_worker *w, const tvi_ensemble *e, int block)
{
    const int parameters = tvi_system_parameters(e->system), count = tvi_members_of(e, block);
    const double *value = e->parameters + tvi_first_member(e, block);
    if (!w->crowd) {
        tvi_arena_copy(w->it->history, memory_of(e, block), e->remembered);
        return;
    }
    tvi_arena_copy(w->crowd->history, memory_of(e, block), e->remembered);
    for (int i = 0; i < parameters; i++, value += e->members)
        for (int lane = 0; lane < e->lanes; lane++)
            w->crowd->parameters[i * e->lanes + lane] = value[lane < count ? lane : 0];
    if (parameters > 0) tvi_crowd_apply_parameters(w->crowd);
}

void tvi_worker_store(const tvi_worker *w, tvi_ensemble *e, int block)
{
    tvi_arena_copy(memory_of(e, block), w->crowd ? w->crowd->history : w->it->history, e->remembered);
}

void tvi_worker_enter(tvi_worker *w, const tvi_ensemble *e, int member)
{
    if (w->crowd) tvi_crowd_get(w->crowd, member % e->lanes, w->it);
    tvi_integrator_lend_parameters(w->it, e->parameters + member, e->members);
    memcpy(w->it->stop, stop_of(e, member), tvi_stop_bytes(e->n));
    w->it->has_dense = false;
}

void tvi_worker_leave(tvi_worker *w, const tvi_ensemble *e, int member)
{
    if (w->crowd) tvi_crowd_put(w->crowd, member % e->lanes, w->it);
    memcpy(stop_of(e, member), w->it->stop, tvi_stop_bytes(e->n));
}

/* ---- What is asked of all ---------------------------------------------------------------------------------------- */

tvi_status tvi_ensemble_set_parameters(tvi_ensemble *e, const double value[])
{
    if (!e || !value)
        return tvi_refuse_null(2, (const void *const[]){e, value}, (const char *const[]){"ensemble", "value"});
    for (size_t i = 0; i < parameter_count(e); i++)
        if (!isfinite(value[i])) return jet_refuse(TVI_ENONFINITE, "value[%zu] is not finite", i);
    memmove(e->parameters, value, parameter_count(e) * sizeof *value);
    memset(e->stops, 0, (size_t)e->members * tvi_stop_bytes(e->n)); /* the events were others */
    tvi_ensemble_reset(e);
    return TVI_OK;
}

void tvi_ensemble_reset(tvi_ensemble *e)
{
    if (!e) return;
    memset(e->memory, 0, (size_t)e->blocks * e->remembered);
    memset(e->failed, 0, (size_t)e->members * sizeof *e->failed);
    for (int i = 0; i < e->threads; i++) {
        e->worker[i].it->stats.largest_tail = 0;
        if (e->worker[i].crowd) e->worker[i].crowd->stats.largest_tail = 0;
    }
    e->before.largest_tail = 0;
    e->has_run = false;
}

static void add_stats(tvi_stats *sum, const tvi_stats *of)
{
    sum->steps += of->steps;
    sum->passes += of->passes;
    sum->expansions += of->expansions;
    sum->force_evaluations += of->force_evaluations;
    sum->factorisations += of->factorisations;
    sum->largest_tail = fmax(sum->largest_tail, of->largest_tail);
    sum->bytes += of->bytes;
}

tvi_status tvi_ensemble_stats(const tvi_ensemble *e, tvi_stats *stats)
{
    if (!e || !stats)
        return tvi_refuse_null(2, (const void *const[]){e, stats}, (const char *const[]){"ensemble", "stats"});
    *stats = e->before;
    stats->bytes = sizeof *e + (size_t)e->blocks * e->remembered + parameter_count(e) * sizeof *e->parameters +
                   (size_t)e->members * (sizeof *e->failed + tvi_stop_bytes(e->n));
    for (int i = 0; i < e->threads; i++) {
        add_stats(stats, &e->worker[i].it->stats);
        if (e->worker[i].crowd) add_stats(stats, &e->worker[i].crowd->stats);
    }
    stats->is_compiled = e->worker->it->stats.is_compiled;
    return TVI_OK;
}
