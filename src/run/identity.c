/* identity.c - see identity.h. */
#include "run/identity.h"
#include "compiled/compiled.h"
#include "method/fingerprint.h"
#include "system/refuse.h"

#include <string.h>

enum { STATE_VERSION = 10 };

static const char MAGIC[] = "tvistate";

tvi_identity tvi_identity_of(const tvi_integrator *it, size_t bytes)
{
    tvi_identity who = {
        .version = STATE_VERSION,
        .bytes = (int64_t)bytes,
        .n = it->system->n,
        .has_stepped = *it->continues,
        .system = tvi_system_fingerprint(it->stepped),
        .options = tvi_options_fingerprint(&it->options),
        .code = it->options.compiled ? tvi_compiled_library() : 0,
    };
    memcpy(who.magic, MAGIC, sizeof who.magic);
    return who;
}

tvi_status tvi_identity_room(const void *buffer, size_t bytes, size_t *size)
{
    if (buffer && *size < bytes) return jet_refuse(TVI_EINVAL, "the buffer has %zu bytes, the state %zu", *size, bytes);
    *size = bytes;
    return TVI_OK;
}

void tvi_identity_seal(void *buffer, size_t size)
{
    const size_t before = size - sizeof(uint64_t);
    const uint64_t checksum = jet_hash(JET_HASH_OF_NOTHING, buffer, before);
    memcpy((char *)buffer + before, &checksum, sizeof checksum);
}

const char *tvi_identity_fault(const void *buffer, size_t size, tvi_identity *who)
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

const char *tvi_identity_misfit(const tvi_identity *own, const tvi_identity *who)
{
    if (who->members != own->members)
        return who->members == 0   ? "the state is of an integrator"
               : own->members == 0 ? "the state is of an ensemble"
                                   : "the state is of an ensemble of another size";
    if (who->n != own->n) return "the state is of a system of another dimension";
    if (who->system != own->system) return "the state is of another system";
    if (who->code != own->code)
        return own->code ? "the state is not of compiled steps" : "the state is of compiled steps";
    const bool fits = who->options == own->options && who->bytes == own->bytes && who->lanes == own->lanes;
    return fits ? NULL : "the state is of other options";
}
