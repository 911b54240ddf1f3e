/* ensemble_state.c - what an ensemble holds between runs, as bytes (state.c):
 *
 *     identity | counts | statuses | parameters | stops | histories | checksum */
#include "run/ensemble.h"
#include "run/identity.h"
#include "system/refuse.h"

#include <string.h>

/* Of the ensemble's own, between the identity and the checksum. */
enum { PIECES = 4 };
typedef struct {
    void *data;
    size_t bytes;
} piece;

static size_t list_pieces(const tvi_ensemble *e, piece list[PIECES])
{
    const size_t members = (size_t)e->members, parameters = (size_t)tvi_system_parameters(e->system);
    const piece all[PIECES] = {
        {e->failed, members * sizeof *e->failed},
        {e->parameters, members * parameters * sizeof *e->parameters},
        {e->stops, members * tvi_stop_bytes(e->n)},
        {e->memory, (size_t)e->blocks * e->remembered},
    };
    memcpy(list, all, sizeof all);
    return sizeof(tvi_identity) + sizeof(tvi_stats) + all[0].bytes + all[1].bytes + all[2].bytes + all[3].bytes +
           sizeof(uint64_t);
}

static tvi_identity identity_of(const tvi_ensemble *e, size_t bytes)
{
    tvi_identity who = tvi_identity_of(e->worker->it, bytes);
    who.has_stepped = e->has_run;
    who.members = e->members;
    who.lanes = e->lanes;
    return who;
}

tvi_status tvi_ensemble_save(const tvi_ensemble *e, void *buffer, size_t *size)
{
    if (!e || !size) return jet_refuse(TVI_EINVAL, "%s is NULL", e ? "size" : "ensemble");
    piece list[PIECES];
    const size_t bytes = list_pieces(e, list);
    tvi_stats stats;
    tvi_status status = tvi_identity_room(buffer, bytes, size);
    if (status == TVI_OK) status = tvi_ensemble_stats(e, &stats);
    if (!buffer || status != TVI_OK) return status;
    const tvi_identity who = identity_of(e, bytes);
    char *at = buffer;
    memcpy(at, &who, sizeof who);
    memcpy(at += sizeof who, &stats, sizeof stats);
    at += sizeof stats;
    for (int i = 0; i < PIECES; at += list[i++].bytes) memcpy(at, list[i].data, list[i].bytes);
    tvi_identity_seal(buffer, bytes);
    return TVI_OK;
}

/* The counts begin with these. */
static void set_stats(tvi_ensemble *e, const char *from)
{
    memcpy(&e->before, from, sizeof e->before);
    for (int i = 0; i < e->threads; i++) {
        tvi_worker *w = &e->worker[i];
        tvi_stats *const all[] = {&w->it->stats, w->crowd ? &w->crowd->stats : NULL};
        for (int k = 0; k < 2; k++)
            if (all[k]) *all[k] = (tvi_stats){.bytes = all[k]->bytes, .is_compiled = all[k]->is_compiled};
    }
}

tvi_status tvi_ensemble_load(tvi_ensemble *e, const void *buffer, size_t size)
{
    if (!e || !buffer) return jet_refuse(TVI_EINVAL, "%s is NULL", e ? "buffer" : "ensemble");
    piece list[PIECES];
    const tvi_identity own = identity_of(e, list_pieces(e, list));
    tvi_identity who;
    const char *reason = tvi_identity_fault(buffer, size, &who), *at = buffer;
    if (!reason) reason = tvi_identity_misfit(&own, &who);
    if (reason) return jet_refuse(TVI_EINVAL, "%s", reason);
    const char *stops = at + sizeof who + sizeof e->before + list[0].bytes + list[1].bytes;
    for (int member = 0; member < e->members; member++)
        if (!tvi_stop_is_sound(stops + (size_t)member * tvi_stop_bytes(e->n)))
            return jet_refuse(TVI_EINVAL, "the state is damaged");
    set_stats(e, at += sizeof who);
    at += sizeof e->before;
    for (int i = 0; i < PIECES; at += list[i++].bytes) memcpy(list[i].data, at, list[i].bytes);
    e->has_run = who.has_stepped != 0;
    return TVI_OK;
}

tvi_status tvi_ensemble_last(const tvi_ensemble *e, double t[], double q[], double p[], tvi_status status[])
{
    if (!e || !t || !q || !p || !status)
        return tvi_refuse_null(5, (const void *const[]){e, t, q, p, status},
                               (const char *const[]){"ensemble", "t", "q", "p", "status"});
    if (!e->has_run) return jet_refuse(TVI_EINVAL, "the ensemble has made no run, or was reset");
    tvi_worker *w = e->worker;
    const size_t members = (size_t)e->members;
    for (int member = 0; member < e->members; member++) {
        const size_t m = (size_t)member;
        if (member % e->lanes == 0) tvi_worker_load(w, e, member / e->lanes);
        tvi_worker_enter(w, e, member);
        for (int i = 0; i < e->n; i++) {
            q[(size_t)i * members + m] = w->it->now.q[i];
            p[(size_t)i * members + m] = w->it->now.p[i];
        }
        t[member] = w->it->now.q[e->n];
        status[member] = e->failed[member];
    }
    return TVI_OK;
}
