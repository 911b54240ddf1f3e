/* state.c - what an integrator holds between steps, as bytes: a run goes on from them as if it had not been
 * interrupted.
 *
 *     identity | t, q, p | counts | parameters | history | checksum
 *
 * The identity is of the format, the method and the system: another one is refused. t, q and p are for those
 * who have no integrator (tvi_state_peek). The history is all that one step
 * leaves to the next (arena.h), so that nothing can be forgotten here. */
#include "compiled/compiled.h"
#include "method/fingerprint.h"
#include "run/integrator.h"
#include "system/refuse.h"

#include <string.h>

enum { STATE_VERSION = 4 };

static const char MAGIC[] = "tvistate";

/* Numbers of eight bytes, without gaps; those of another byte order have another version. */
typedef struct {
    char magic[8];
    int64_t version, bytes, n, has_stepped;
    uint64_t system, options, code; /* code: 0 where there is none, since the tape rounds otherwise */
} identity;

/* t, q and p. */
static size_t seen_size(int64_t n) { return (1 + 2 * (size_t)n) * sizeof(double); }

static size_t parameter_bytes(const tvi_integrator *it)
{
    return (size_t)tvi_system_parameters(it->system) * sizeof *it->parameters;
}

static size_t state_size(const tvi_integrator *it)
{
    return sizeof(identity) + seen_size(it->system->n) + sizeof(tvi_stats) + parameter_bytes(it) + it->remembered +
           sizeof(uint64_t);
}

static identity identity_of(const tvi_integrator *it)
{
    identity who = {
        .version = STATE_VERSION,
        .bytes = (int64_t)state_size(it),
        .n = it->system->n,
        .has_stepped = *it->continues,
        .system = tvi_system_fingerprint(it->stepped),
        .options = tvi_options_fingerprint(&it->options),
        .code = it->options.compiled ? tvi_compiled_library() : 0,
    };
    memcpy(who.magic, MAGIC, sizeof who.magic);
    return who;
}

tvi_status tvi_state_save(const tvi_integrator *it, void *buffer, size_t *size)
{
    if (!it || !size) return jet_refuse(TVI_EINVAL, "%s is NULL", it ? "size" : "integrator");
    if (buffer && *size < state_size(it))
        return jet_refuse(TVI_EINVAL, "the buffer has %zu bytes, the state %zu", *size, state_size(it));
    *size = state_size(it);
    if (!buffer) return TVI_OK;
    const identity who = identity_of(it);
    char *at = buffer;
    const size_t n = (size_t)it->system->n;
    memcpy(at, &who, sizeof who);
    memcpy(at += sizeof who, &it->now.q[n], sizeof *it->now.q);
    memcpy(at += sizeof *it->now.q, it->now.q, n * sizeof *it->now.q);
    memcpy(at += n * sizeof *it->now.q, it->now.p, n * sizeof *it->now.p);
    memcpy(at += n * sizeof *it->now.p, &it->stats, sizeof it->stats);
    memcpy(at += sizeof it->stats, it->parameters, parameter_bytes(it));
    tvi_arena_copy(at += parameter_bytes(it), it->history, it->remembered);
    const uint64_t checksum = jet_hash(JET_HASH_OF_NOTHING, buffer, *size - sizeof checksum);
    memcpy(at + it->remembered, &checksum, sizeof checksum);
    return TVI_OK;
}

/* Why the bytes are no state, or NULL: then whose. */
static const char *fault(const void *buffer, size_t size, identity *who)
{
    uint64_t checksum;
    if (size < sizeof *who + sizeof checksum) return "the bytes are too few for a state";
    memcpy(who, buffer, sizeof *who);
    memcpy(&checksum, (const char *)buffer + size - sizeof checksum, sizeof checksum);
    if (memcmp(who->magic, MAGIC, sizeof who->magic) != 0) return "the bytes are no state";
    if (who->version != STATE_VERSION) return "the state is of another version of the library";
    const bool is_sound = checksum == jet_hash(JET_HASH_OF_NOTHING, buffer, size - sizeof checksum);
    return is_sound && who->bytes == (int64_t)size ? NULL : "the state is damaged";
}

/* Why the state is of no integrator with this identity, or NULL. */
static const char *misfit(const identity *own, const identity *who)
{
    if (who->n != own->n) return "the state is of a system of another dimension";
    if (who->system != own->system) return "the state is of another system";
    if (who->code != own->code)
        return own->code ? "the state is not of compiled steps" : "the state is of compiled steps";
    return who->options != own->options || who->bytes != own->bytes ? "the state is of other options" : NULL;
}

tvi_status tvi_state_load(tvi_integrator *it, const void *buffer, size_t size)
{
    if (!it || !buffer) return jet_refuse(TVI_EINVAL, "%s is NULL", it ? "buffer" : "integrator");
    const identity own = identity_of(it);
    identity who;
    const char *reason = fault(buffer, size, &who), *at = buffer;
    if (!reason) reason = misfit(&own, &who);
    if (reason) return jet_refuse(TVI_EINVAL, "%s", reason);
    const tvi_stats stats = it->stats;
    memcpy(&it->stats, at += sizeof own + seen_size(own.n), sizeof it->stats);
    it->stats.bytes = stats.bytes;
    it->stats.is_compiled = stats.is_compiled;
    memcpy(it->parameters, at += sizeof it->stats, parameter_bytes(it));
    tvi_arena_copy(it->history, at + parameter_bytes(it), it->remembered);
    tvi_integrator_apply_parameters(it);
    it->has_dense = false;
    return TVI_OK;
}

tvi_status tvi_state_peek(const void *buffer, size_t size, int *n, double *t, double q[], double p[])
{
    identity who;
    if (!buffer || !n) return jet_refuse(TVI_EINVAL, "%s is NULL", buffer ? "n" : "buffer");
    const char *const reason = fault(buffer, size, &who), *at = (const char *)buffer + sizeof who;
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
    const size_t n = (size_t)it->system->n;
    memcpy(q, it->now.q, n * sizeof *q);
    memcpy(p, it->now.p, n * sizeof *p);
    *t = it->now.q[n];
    return TVI_OK;
}
