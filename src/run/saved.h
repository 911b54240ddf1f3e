/* saved.h - states as bytes: whose they are, what is in them, and a checksum.
 *
 *     identity | pieces | checksum
 *
 * An integrator and an ensemble list their pieces; this writes and reads them. */
#ifndef TVI_SRC_RUN_SAVED_H
#define TVI_SRC_RUN_SAVED_H

#include "run/integrator.h"

#include <stdint.h>

/* Numbers of eight bytes, without gaps; those of another byte order have another version. It stands first in the bytes,
 * and a checksum of all of them last. */
typedef struct {
    char magic[8];
    int64_t version, bytes, n, has_stepped;
    int64_t members, width;         /* of an ensemble, and of its batches; 0: an integrator */
    uint64_t system, options, code; /* code: 0 where there is none, since the tape rounds otherwise */
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

/* All bytes of a state with these pieces. */
size_t tvi_saved_size(const tvi_pieces *pieces);
/* The identity of the integrator, with so many bytes. */
tvi_identity tvi_identity_of(const tvi_integrator *integrator, size_t bytes);

/* Sets *size, and writes the bytes into a buffer that is not NULL.
 *   TVI_EINVAL  the buffer is too small */
TVI_NODISCARD tvi_status tvi_saved_write(const tvi_identity *own, const tvi_pieces *pieces, void *buffer, size_t *size);

/* Completes bytes that are written but for their checksum. */
void tvi_saved_seal(void *buffer, size_t size);

/* Whose the bytes are, and that their checksum is right; else why they are no state. */
const char *tvi_saved_fault(const void *buffer, size_t size, tvi_identity *who);
/* Why the bytes are no state of one with this identity, or NULL. */
const char *tvi_saved_misfit(const tvi_identity *own, const void *buffer, size_t size);
/* Where the bytes of the piece of this index stand in the buffer. */
const char *tvi_saved_piece(const tvi_pieces *pieces, int index, const void *buffer);
/* Copies this piece from a buffer that fits. */
void tvi_saved_read(const tvi_pieces *pieces, int index, const void *buffer);

/* Whether bytes from elsewhere are counts that a run may go on from. */
bool tvi_stats_are_sound(const void *bytes);
/* Whether bytes from elsewhere are finite numbers. */
bool tvi_numbers_are_finite(const void *bytes, size_t size);
/* Whether bytes from elsewhere are so many stops of dimension n, one after the other. */
bool tvi_stops_are_sound(const void *bytes, int n, int members);
/* Whether the integrator's history, which came from elsewhere, is one that steps can go on from: its numbers are
 * finite, and its indices are within their arrays. */
bool tvi_history_is_sound(const tvi_integrator *integrator);

#endif
