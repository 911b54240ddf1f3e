/* identity.h - whose the bytes of a saved state are. */
#ifndef TVI_SRC_RUN_IDENTITY_H
#define TVI_SRC_RUN_IDENTITY_H

#include "run/integrator.h"

#include <stdint.h>

/* Numbers of eight bytes, without gaps; those of another byte order have another version. It stands first in the bytes,
 * and a checksum of all of them last. */
typedef struct {
    char magic[8];
    int64_t version, bytes, n, has_stepped;
    int64_t members, lanes;         /* of an ensemble; 0: an integrator */
    uint64_t system, options, code; /* code: 0 where there is none, since the tape rounds otherwise */
} tvi_identity;

/* Of so many bytes of an integrator's. */
tvi_identity tvi_identity_of(const tvi_integrator *integrator, size_t bytes);

/* TVI_EINVAL where the buffer is too small; else *size is the size, and a buffer that is NULL is no error. */
TVI_NODISCARD tvi_status tvi_identity_room(const void *buffer, size_t bytes, size_t *size);
/* Completes bytes that are written but for their checksum. */
void tvi_identity_seal(void *buffer, size_t size);

/* Why the bytes are no state, or NULL: then whose. */
const char *tvi_identity_fault(const void *buffer, size_t size, tvi_identity *who);
/* Why the state is of no one with this identity, or NULL. */
const char *tvi_identity_misfit(const tvi_identity *own, const tvi_identity *who);

#endif
