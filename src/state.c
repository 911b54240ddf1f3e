/* state.c - what an integrator holds between steps, as bytes: a run goes on from them as if it had not been
 * interrupted.
 *
 *     identity | counts | history | checksum
 *
 * The identity is of the format, the method and the system: another one is refused. The history is all that one step
 * leaves to the next (arena.h), so that nothing can be forgotten here. */
#include "integrator.h"

#include <stdint.h>
#include <string.h>

enum { STATE_VERSION = 1 };

/* Numbers of eight bytes, without gaps; those of another byte order have another version. */
typedef struct {
    char magic[8];
    int64_t version, bytes, n, form, options[10];
    double tolerance;
    uint64_t system;
} identity;

/* FNV-1a. Each step is a bijection of the hash, so one damaged byte always shows. */
static uint64_t hash(uint64_t so_far, const void *data, size_t bytes)
{
    const unsigned char *byte = data;
    /* NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): the caller states the bytes */
    for (size_t i = 0; i < bytes; i++) so_far = (so_far ^ byte[i]) * UINT64_C(0x100000001b3);
    return so_far;
}
static const uint64_t NOTHING = UINT64_C(0xcbf29ce484222325);

/* Of the masses and all that the tape of the field does. */
static uint64_t hash_system(const tvi_system *system)
{
    const jet_tape *tape = system->field_values;
    const size_t terms = (size_t)tape->terms;
    uint64_t sum = hash(NOTHING, system->mass, system->form == TVI_SEPARABLE ? (size_t)system->n * sizeof(double) : 0);
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) {
        const int places[] = {(int)run->op, run->count, run->z, run->a, run->b, run->terms};
        sum = hash(sum, places, sizeof places);
        sum = hash(sum, &run->c, sizeof run->c);
    }
    sum = hash(sum, tape->constant, (size_t)tape->constants * sizeof *tape->constant);
    sum = hash(sum, tape->base, (size_t)tape->rows * sizeof *tape->base);
    sum = hash(sum, tape->term_slot, terms * sizeof *tape->term_slot);
    sum = hash(sum, tape->term_coefficient, terms * sizeof *tape->term_coefficient);
    return hash(sum, tape->output, (size_t)tape->outputs * sizeof *tape->output);
}

static size_t state_size(const tvi_integrator *it)
{
    return sizeof(identity) + sizeof(tvi_stats) + it->remembered + sizeof(uint64_t);
}

static identity identity_of(const tvi_integrator *it)
{
    const tvi_options *o = &it->options;
    return (identity){
        .magic = {'t', 'v', 'i', 's', 't', 'a', 't', 'e'},
        .version = STATE_VERSION,
        .bytes = (int64_t)state_size(it),
        .n = it->system->n,
        .form = it->system->form,
        .options = {o->method, o->expansion, o->nodes, o->order, o->degree, o->compose_adjoint, o->quadrature,
                    o->quadrature_points, o->passes, o->max_passes},
        .tolerance = o->tolerance,
        .system = hash_system(it->system),
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
    memcpy(at += sizeof it->stats, it->history, it->remembered);
    const uint64_t checksum = hash(NOTHING, buffer, *size - sizeof checksum);
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
    if (memcmp(at, &who, sizeof who) != 0 || checksum != hash(NOTHING, buffer, size - sizeof checksum))
        return TVI_EINVAL;
    const size_t bytes = it->stats.bytes;
    memcpy(&it->stats, at += sizeof who, sizeof it->stats);
    it->stats.bytes = bytes;
    memcpy(it->history, at + sizeof it->stats, it->remembered);
    it->has_dense = false;
    return TVI_OK;
}

tvi_status tvi_state_last(const tvi_integrator *it, double *t, double q[], double p[])
{
    if (!it || !t || !q || !p || !it->last->continues) return TVI_EINVAL;
    *t = it->last->t;
    memcpy(q, it->q, (size_t)it->system->n * sizeof *q);
    memcpy(p, it->p, (size_t)it->system->n * sizeof *p);
    return TVI_OK;
}
