/* state.c - what an integrator holds between steps, as bytes: a run goes on from them as if it had not been
 * interrupted.
 *
 *     identity | counts | history | checksum
 *
 * The identity is of the format, the method and the system: another one is refused. The history is all that one step
 * leaves to the next (arena.h), so that nothing can be forgotten here. */
#include "run/fingerprint.h"
#include "run/integrator.h"

#include <string.h>

enum { STATE_VERSION = 3 };

/* Numbers of eight bytes, without gaps; those of another byte order have another version. */
typedef struct {
    char magic[8];
    int64_t version, bytes, n;
    uint64_t system, options;
} identity;

static size_t state_size(const tvi_integrator *it)
{
    return sizeof(identity) + sizeof(tvi_stats) + it->remembered + sizeof(uint64_t);
}

static identity identity_of(const tvi_integrator *it)
{
    return (identity){
        .magic = {'t', 'v', 'i', 's', 't', 'a', 't', 'e'},
        .version = STATE_VERSION,
        .bytes = (int64_t)state_size(it),
        .n = it->system->n,
        .system = tvi_system_fingerprint(it->stepped),
        .options = tvi_options_fingerprint(&it->options),
    };
}

tvi_status tvi_state_save(const tvi_integrator *it, void *buffer, size_t *size)
{
    if (!it || !size || (buffer && *size < state_size(it))) return TVI_EINVAL;
    *size = state_size(it);
    if (!buffer) return TVI_OK;
    const identity who = identity_of(it);
    char *at = buffer;
    memcpy(at, &who, sizeof who);
    memcpy(at += sizeof who, &it->stats, sizeof it->stats);
    tvi_arena_copy(at += sizeof it->stats, it->history, it->remembered);
    const uint64_t checksum = jet_hash(JET_HASH_OF_NOTHING, buffer, *size - sizeof checksum);
    memcpy(at + it->remembered, &checksum, sizeof checksum);
    return TVI_OK;
}

tvi_status tvi_state_load(tvi_integrator *it, const void *buffer, size_t size)
{
    if (!it || !buffer || size != state_size(it)) return TVI_EINVAL;
    const identity who = identity_of(it);
    const char *at = buffer;
    uint64_t checksum;
    memcpy(&checksum, at + size - sizeof checksum, sizeof checksum);
    if (memcmp(at, &who, sizeof who) != 0 || checksum != jet_hash(JET_HASH_OF_NOTHING, buffer, size - sizeof checksum))
        return TVI_EINVAL;
    const size_t bytes = it->stats.bytes;
    memcpy(&it->stats, at += sizeof who, sizeof it->stats);
    it->stats.bytes = bytes;
    tvi_arena_copy(it->history, at + sizeof it->stats, it->remembered);
    it->has_dense = false;
    return TVI_OK;
}

tvi_status tvi_state_last(const tvi_integrator *it, double *t, double q[], double p[])
{
    if (!it || !t || !q || !p || !*it->continues) return TVI_EINVAL;
    const size_t n = (size_t)it->system->n;
    memcpy(q, it->now.q, n * sizeof *q);
    memcpy(p, it->now.p, n * sizeof *p);
    *t = it->now.q[n];
    return TVI_OK;
}
