/* state.c - what an integrator holds between steps, as bytes: a run goes on from them as if it had not been
 * interrupted.
 *
 *     identity | t, q, p | counts | parameters | stop | history | checksum
 *
 * The identity is of the format, the method and the system: another one is refused (identity.h). t, q and p are for
 * those who have no integrator (tvi_state_peek). The history is all that one step leaves to the next (arena.h), so that
 * nothing can be forgotten here. */
#include "run/identity.h"
#include "system/refuse.h"

#include <string.h>

/* t, q and p. */
static size_t seen_size(int64_t n) { return (1 + 2 * (size_t)n) * sizeof(double); }

static size_t parameter_bytes(const tvi_integrator *it)
{
    return (size_t)tvi_system_parameters(it->system) * sizeof *it->parameters;
}

static size_t state_size(const tvi_integrator *it)
{
    return sizeof(tvi_identity) + seen_size(it->system->n) + sizeof(tvi_stats) + parameter_bytes(it) +
           tvi_stop_bytes(it->system->n) + it->remembered + sizeof(uint64_t);
}

tvi_status tvi_state_save(const tvi_integrator *it, void *buffer, size_t *size)
{
    if (!it || !size) return jet_refuse(TVI_EINVAL, "%s is NULL", it ? "size" : "integrator");
    const tvi_status status = tvi_identity_room(buffer, state_size(it), size);
    if (!buffer || status != TVI_OK) return status;
    const tvi_identity who = tvi_identity_of(it, *size);
    char *at = buffer;
    const size_t n = (size_t)it->system->n;
    memcpy(at, &who, sizeof who);
    memcpy(at += sizeof who, &it->now.q[n], sizeof *it->now.q);
    memcpy(at += sizeof *it->now.q, it->now.q, n * sizeof *it->now.q);
    memcpy(at += n * sizeof *it->now.q, it->now.p, n * sizeof *it->now.p);
    memcpy(at += n * sizeof *it->now.p, &it->stats, sizeof it->stats);
    memcpy(at += sizeof it->stats, it->parameters, parameter_bytes(it));
    memcpy(at += parameter_bytes(it), it->stop, tvi_stop_bytes(it->system->n));
    tvi_arena_copy(at += tvi_stop_bytes(it->system->n), it->history, it->remembered);
    tvi_identity_seal(buffer, *size);
    return TVI_OK;
}

tvi_status tvi_state_load(tvi_integrator *it, const void *buffer, size_t size)
{
    if (!it || !buffer) return jet_refuse(TVI_EINVAL, "%s is NULL", it ? "buffer" : "integrator");
    if (it->is_telling)
        return jet_refuse(TVI_EINVAL, "the integrator is in a run, whose observer may not load a state");
    const tvi_identity own = tvi_identity_of(it, state_size(it));
    tvi_identity who;
    const char *reason = tvi_identity_fault(buffer, size, &who), *at = buffer;
    if (!reason) reason = tvi_identity_misfit(&own, &who);
    if (reason) return jet_refuse(TVI_EINVAL, "%s", reason);
    const char *stop = (const char *)buffer + sizeof own + seen_size(own.n) + sizeof it->stats + parameter_bytes(it);
    if (!tvi_stop_is_sound(stop)) return jet_refuse(TVI_EINVAL, "the state is damaged");
    const tvi_stats stats = it->stats;
    memcpy(&it->stats, at += sizeof own + seen_size(own.n), sizeof it->stats);
    it->stats.bytes = stats.bytes;
    it->stats.is_compiled = stats.is_compiled;
    memcpy(it->parameters, at += sizeof it->stats, parameter_bytes(it));
    memcpy(it->stop, at += parameter_bytes(it), tvi_stop_bytes(it->system->n));
    tvi_arena_copy(it->history, at + tvi_stop_bytes(it->system->n), it->remembered);
    tvi_integrator_apply_parameters(it);
    it->parameter_sets++;
    it->has_dense = false;
    return TVI_OK;
}

tvi_status tvi_state_peek(const void *buffer, size_t size, int *n, double *t, double q[], double p[])
{
    tvi_identity who;
    if (!buffer || !n) return jet_refuse(TVI_EINVAL, "%s is NULL", buffer ? "n" : "buffer");
    const char *reason = tvi_identity_fault(buffer, size, &who), *at = (const char *)buffer + sizeof who;
    const bool has_room = !reason && who.n >= 1 && who.n <= TVI_MAX_DIMENSION && seen_size(who.n) <= size - sizeof who;
    if (!reason && !has_room) reason = "the state is damaged";
    if (!reason && who.members > 0) reason = "the state is of an ensemble";
    if (reason) return jet_refuse(TVI_EINVAL, "%s", reason);
    if (!who.has_stepped && (t || q || p)) return jet_refuse(TVI_EINVAL, "the state is of an integrator before a step");
    const size_t bytes = (size_t)who.n * sizeof(double);
    *n = (int)who.n;
    if (t) memcpy(t, at, sizeof *t);
    if (q) memcpy(q, at + sizeof *t, bytes);
    if (p) memcpy(p, at + sizeof *t + bytes, bytes);
    return TVI_OK;
}

tvi_status tvi_state_last(const tvi_integrator *it, double *t, double q[], double p[])
{
    if (!it || !t || !q || !p || !*it->continues)
        return tvi_refuse_run((tvi_run_arguments){it, t, q, p, 1}, "the integrator has made no step, or was reset");
    tvi_state_now(it, t, q, p);
    return TVI_OK;
}
