/* saved.h - Writes and reads states as bytes, for integrators (state.c) and ensembles. The bytes are
 *
 *      identity | pieces | checksum
 *
 * An integrator and an ensemble list their pieces. */
#ifndef TVI_SRC_RUN_SAVED_H
#define TVI_SRC_RUN_SAVED_H

#include "run/integrator.h"

#include <stdint.h>

/* The identity of what was saved, in numbers of eight bytes without gaps. Bytes of another byte order have another
 * version. The identity comes first in the bytes; a checksum of all of them comes last. */
typedef struct {
    char magic[8];
    int64_t version, bytes, n, has_stepped;
    int64_t members, width; /* of an ensemble, and of its batches; 0: an integrator */
    /* Hashes. code is 0 without generated code, since its steps round otherwise than those of tapes. */
    uint64_t system, options, code;
} tvi_identity;

enum { TVI_MOST_PIECES = 8 };
typedef struct {
    int count;
    struct {
        void *data;
        size_t bytes;
    } piece[TVI_MOST_PIECES];
} tvi_pieces;
static inline void tvi_pieces_add(tvi_pieces *pieces, void *data, size_t bytes)
{
    pieces->piece[pieces->count].data = data;
    pieces->piece[pieces->count++].bytes = bytes;
}

/* The number of bytes of a state with these pieces. */
size_t tvi_saved_size(const tvi_pieces *pieces);
/* The identity of the integrator, for a state of `bytes` bytes. */
tvi_identity tvi_identity_of(const tvi_integrator *integrator, size_t bytes);

/* Sets *size, and writes the bytes into the buffer, if it is not NULL.
 *    TVI_EINVAL  the buffer is too small */
TVI_NODISCARD tvi_status tvi_saved_write(const tvi_identity *own, const tvi_pieces *pieces, void *buffer, size_t *size);

/* Completes bytes that are written up to their checksum. */
void tvi_saved_add_checksum(void *buffer, size_t size);

/* Checks the checksum of the bytes, and reads their identity. Returns NULL, or the reason why they are no state. */
const char *tvi_saved_check(const void *buffer, size_t size, tvi_identity *who);
/* The reason why the bytes are no state with this identity, or NULL. */
const char *tvi_saved_misfit(const tvi_identity *own, const void *buffer, size_t size);
/* The piece with this index in the buffer. */
const char *tvi_saved_piece(const tvi_pieces *pieces, int index, const void *buffer);
/* Copies the piece with this index from a buffer that fits. */
void tvi_saved_read(const tvi_pieces *pieces, int index, const void *buffer);

/* Tells whether loaded bytes are counts that a run may go on from. */
bool tvi_stats_are_sound(const void *bytes);
/* Tells whether loaded bytes are finite numbers. */
bool tvi_numbers_are_finite(const void *bytes, size_t size);
/* Tells whether loaded bytes are `members` stops of dimension n, one after the other. */
bool tvi_stops_are_sound(const void *bytes, int n, int members);
/* Tells whether steps can go on from the integrator's loaded history: its numbers are finite, and its indices are
 * within their arrays. */
bool tvi_history_is_sound(const tvi_integrator *integrator);

#endif
