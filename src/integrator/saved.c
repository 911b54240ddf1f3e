/* saved.c - Writes the state of an integrator or an ensemble as bytes, and checks bytes before they are loaded
 * (saved.h). */
#include "integrator/saved.h"
#include "compiled/compiled.h"
#include "algebra/sizes.h"
#include "method/fingerprint.h"
#include "system/refuse.h"

#include <limits.h>
#include <math.h>
#include <string.h>

enum { STATE_VERSION = 16 };

static const char MAGIC[] = "tvistate";

tvi_saved_identity tvi_saved_identity_of_integrator(const tvi_integrator *it, size_t bytes)
{
    tvi_saved_identity identity = {
        .format_version = STATE_VERSION,
        .total_bytes = (int64_t)bytes,
        .n = it->system->n,
        .has_stepped = *it->is_state_from_step,
        .system_hash = tvi_system_fingerprint(it->stepped),
        .options_hash = tvi_options_fingerprint(&it->options),
        .generated_code_hash = it->options.compiled ? tvi_compiled_hash_library_text() : 0,
    };
    memcpy(identity.magic, MAGIC, sizeof identity.magic);
    return identity;
}

size_t tvi_saved_size_in_bytes(const tvi_saved_pieces *pieces)
{
    size_t bytes = sizeof(tvi_saved_identity) + sizeof(uint64_t);
    for (int i = 0; i < pieces->piece_count; i++) bytes += pieces->piece[i].bytes;
    return bytes;
}

void tvi_saved_add_checksum(void *buffer, size_t size)
{
    const size_t before = size - sizeof(uint64_t);
    const uint64_t checksum = jet_continue_hash(JET_HASH_OF_NOTHING, buffer, before);
    memcpy((char *)buffer + before, &checksum, sizeof checksum);
}

tvi_status tvi_saved_write(const tvi_saved_identity *identity, const tvi_saved_pieces *pieces, void *buffer,
                           size_t *size)
{
    const size_t bytes = tvi_saved_size_in_bytes(pieces);
    if (buffer && *size < bytes) return jet_refuse(TVI_EINVAL, "the buffer has %zu bytes, the state %zu", *size, bytes);
    *size = bytes;
    if (!buffer) return TVI_OK;
    char *at = buffer;
    memcpy(at, identity, sizeof *identity);
    at += sizeof *identity;
    for (int i = 0; i < pieces->piece_count; at += pieces->piece[i++].bytes)
        tvi_arena_copy_history(at, pieces->piece[i].data, pieces->piece[i].bytes);
    tvi_saved_add_checksum(buffer, bytes);
    return TVI_OK;
}

const char *tvi_saved_find_damage(const void *buffer, size_t size, tvi_saved_identity *identity)
{
    uint64_t checksum;
    if (size < sizeof *identity + sizeof checksum) return "the bytes are too few for a state";
    memcpy(identity, buffer, sizeof *identity);
    memcpy(&checksum, (const char *)buffer + size - sizeof checksum, sizeof checksum);
    if (memcmp(identity->magic, MAGIC, sizeof identity->magic) != 0) return "the bytes are no state";
    if (identity->format_version != STATE_VERSION) return "the state is of another version of the library";
    const bool is_sound = checksum == jet_continue_hash(JET_HASH_OF_NOTHING, buffer, size - sizeof checksum);
    return is_sound && identity->total_bytes == (int64_t)size ? NULL : "the state is damaged";
}

const char *tvi_saved_find_mismatch(const tvi_saved_identity *expected, const void *buffer, size_t size)
{
    tvi_saved_identity identity;
    const char *const fault = tvi_saved_find_damage(buffer, size, &identity);
    if (fault) return fault;
    if (identity.member_count != expected->member_count)
        return identity.member_count == 0    ? "the state is of an integrator"
               : expected->member_count == 0 ? "the state is of an ensemble"
                                             : "the state is of an ensemble of another size";
    if (identity.n != expected->n) return "the state is of a system of another dimension";
    if (identity.system_hash != expected->system_hash) return "the state is of another system";
    if (identity.generated_code_hash != expected->generated_code_hash)
        return expected->generated_code_hash ? "the state is not of compiled steps" : "the state is of compiled steps";
    const bool fits = identity.options_hash == expected->options_hash && identity.total_bytes == expected->total_bytes;
    return fits ? NULL : "the state is of other options";
}

const char *tvi_saved_piece_address(const tvi_saved_pieces *pieces, int index, const void *buffer)
{
    const char *at = (const char *)buffer + sizeof(tvi_saved_identity);
    for (int i = 0; i < index; i++) at += pieces->piece[i].bytes;
    return at;
}

void tvi_saved_load_piece(const tvi_saved_pieces *pieces, int index, const void *buffer)
{
    tvi_arena_copy_history(pieces->piece[index].data, tvi_saved_piece_address(pieces, index, buffer),
                           pieces->piece[index].bytes);
}

bool tvi_saved_stats_are_valid(const void *bytes)
{
    /* The last field, is_compiled, is not read: a damaged byte need not be a valid bool. */
    const size_t numbers = offsetof(tvi_stats, is_compiled);
    tvi_stats s = {0};
    memcpy(&s, bytes, numbers);
    const long counts[] = {s.steps, s.passes, s.expansions, s.force_evaluations, s.factorisations};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        if (counts[i] < 0 || counts[i] > LONG_MAX / 2) return false;
    return true;
}

bool tvi_numbers_are_finite(const void *bytes, size_t size)
{
    double number;
    for (const char *at = bytes; at < (const char *)bytes + size; at += sizeof number) {
        memcpy(&number, at, sizeof number);
        if (!isfinite(number)) return false;
    }
    return true;
}

bool tvi_saved_stops_are_valid(const void *bytes, int n, int members)
{
    for (int m = 0; m < members; m++) {
        tvi_event_stop stop;
        memcpy(&stop, (const char *)bytes + (size_t)m * tvi_stop_bytes(n), sizeof stop);
        if (stop.event_count < 0 || stop.event_count > TVI_STOP_EVENTS) return false;
    }
    return true;
}

bool tvi_loaded_history_is_valid(const tvi_integrator *it)
{
    const tvi_run_state *state = &it->state;
    const tvi_reference_energy *reference = it->reference_energy;
    const int dimension = it->stepped->n;
    return tvi_all_finite(dimension + 1, state->q) && tvi_all_finite(dimension + 1, state->q_low) &&
           tvi_all_finite(dimension, state->p) && tvi_all_finite(dimension, state->p_low) &&
           isfinite(reference->zero_level) && isfinite(reference->energy_scale) &&
           (!reference->is_H_known || isfinite(reference->H)) &&
           (!it->stepper->is_history_valid || it->stepper->is_history_valid(it->work));
}
