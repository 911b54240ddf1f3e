/* saved.h - Writes the state of an integrator or of an ensemble as bytes, and checks such bytes before they are loaded.
 * state.c and ensemble.c call it. The bytes are
 *
 *      identity | pieces | checksum
 *
 * A piece is a block of memory, for example the parameters or the history. state.c lists the pieces of an integrator,
 * and ensemble.c those of an ensemble (tvi_saved_pieces). */
#ifndef TVI_INTEGRATOR_SAVED_H
#define TVI_INTEGRATOR_SAVED_H

#include "integrator/integrator.h"

#include <stdint.h>

/* The first part of the bytes of a saved state. It describes the format, the system and the method. All fields have
 * eight bytes, so that there are no gaps. A machine with another byte order reads another version number, so it refuses
 * the state. */
typedef struct {
    char magic[8]; /* "tvistate", by which saved states are recognized */
    /* The version of the format, the size of the saved state in bytes, and the number of coordinates of the system. */
    int64_t format_version, total_bytes, n;
    int64_t has_stepped;                /* 1 if the integrator or the ensemble has made a step, otherwise 0 */
    int64_t member_count;               /* the number of members of an ensemble; 0 for an integrator */
    uint64_t system_hash, options_hash; /* hashes of the system's tapes and of the options */
    /* The hash of the generated code, whose roundoff differs from that of tapes; 0 if there is none. */
    uint64_t generated_code_hash;
} tvi_saved_identity;

enum { TVI_MAX_SAVED_PIECES = 8 };
/* The pieces of memory that are saved one after the other. */
typedef struct {
    int piece_count;
    struct {
        void *data;
        size_t bytes;
    } piece[TVI_MAX_SAVED_PIECES];
} tvi_saved_pieces;
static inline void tvi_saved_pieces_add(tvi_saved_pieces *pieces, void *data, size_t bytes)
{
    pieces->piece[pieces->piece_count].data = data;
    pieces->piece[pieces->piece_count++].bytes = bytes;
}

/* Returns the number of bytes of a saved state with these pieces. */
size_t tvi_saved_size_in_bytes(const tvi_saved_pieces *pieces);
/* Returns the identity of the integrator's saved state, which has the given number of bytes. */
tvi_saved_identity tvi_saved_identity_of_integrator(const tvi_integrator *integrator, size_t bytes);

/* Sets *size to the number of bytes of the state, and writes the bytes to the buffer unless that is NULL. Returns
 * TVI_EINVAL if a buffer of *size bytes is too small. */
TVI_NODISCARD tvi_status tvi_saved_write(const tvi_saved_identity *identity, const tvi_saved_pieces *pieces,
                                         void *buffer, size_t *size);

/* Computes the checksum of a state that has been written to the buffer, and writes it to the last eight bytes. */
void tvi_saved_add_checksum(void *buffer, size_t size);

/* Checks the checksum of a saved state, and copies its identity. Returns NULL, or a message that tells why the bytes
 * are not a valid state. */
const char *tvi_saved_find_damage(const void *buffer, size_t size, tvi_saved_identity *identity);
/* Returns NULL if the buffer has a valid state with the identity `expected`, otherwise a message that tells the
 * difference. */
const char *tvi_saved_find_mismatch(const tvi_saved_identity *expected, const void *buffer, size_t size);
/* Returns the address in the buffer of the piece with this index. */
const char *tvi_saved_piece_address(const tvi_saved_pieces *pieces, int index, const void *buffer);
/* Copies the piece with this index from the buffer to its place in memory. */
void tvi_saved_load_piece(const tvi_saved_pieces *pieces, int index, const void *buffer);

/* Tells whether the bytes are valid counts of steps (tvi_stats). */
bool tvi_saved_stats_are_valid(const void *bytes);
/* Tells whether the bytes are finite numbers of type double. */
bool tvi_numbers_are_finite(const void *bytes, size_t size);
/* Tells whether the bytes are valid stops (tvi_event_stop) of this number of members, one after the other. */
bool tvi_saved_stops_are_valid(const void *bytes, int n, int members);
/* Tells whether steps can go on from the history (integrator.h) that the integrator has loaded: its numbers are
 * finite, and its indices lie within their arrays. */
bool tvi_loaded_history_is_valid(const tvi_integrator *integrator);

#endif
