/* arena.h - Allocates the memory of an integrator in one piece, an arena. The code that lays out the arrays runs
 * twice: first to measure, while the arena has no memory, and then to get the addresses. With the address sanitizer,
 * a gap that must not be accessed follows each array. All parts of an integrator, and the tools for single states,
 * allocate here. */
#ifndef TVI_SRC_ARENA_H
#define TVI_SRC_ARENA_H

#include "compiler.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#if defined(__SANITIZE_ADDRESS__)
#define ARENA_HAS_GAPS
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ARENA_HAS_GAPS
#endif
#endif

typedef struct tvi_tape_block tvi_tape_block;

/* The arena. Its history is a region that contains everything one step leaves to the next one. All zeros are the
 * history before a first step. The owner of the memory can therefore copy, restore, clear and save the history without
 * knowing its contents.
 *
 * The history has two parts. The first one is copied before each step, and restored if the step fails. The second one,
 * the uncopied history, is neither copied nor restored: it contains data that is set at the start of a run, and ring
 * buffers that steps fill in turn. The copied history says which buffer is the current one. */
typedef struct tvi_arena {
    char *memory, *history, *uncopied_history;
    /* The numbers of bytes that are allocated so far outside of the history, in the copied history, and in the uncopied
     * history. */
    size_t bytes_outside_history, copied_history_bytes, uncopied_history_bytes;
    /* The first of the blocks that were allocated in this arena; they form a list (block.h). */
    const tvi_tape_block *first_tape_block;
} tvi_arena;

/* Alignment of arrays in bytes. Arrays of the copied history are closer together, since each step copies them. */
enum { ARENA_ALIGNMENT = 64, ARENA_COPIED_ALIGNMENT = 16 };

#ifdef ARENA_HAS_GAPS
#include <sanitizer/asan_interface.h>
enum { ARENA_GAP = ARENA_ALIGNMENT };
#define ARENA_NO_SANITIZER JET_UNCHECKED
#else
enum { ARENA_GAP = 0 };
#define ASAN_POISON_MEMORY_REGION(address, bytes) ((void)(address), (void)(bytes))
#define ARENA_NO_SANITIZER
#endif

/* Rounds a number of bytes up to a multiple of the alignment. */
static inline size_t tvi_arena_round_up(size_t bytes, size_t alignment)
{
    return (bytes + alignment - 1) / alignment * alignment;
}

/* Returns the size of both parts of the history in bytes. */
static inline size_t tvi_arena_history_bytes(const tvi_arena *arena)
{
    return tvi_arena_round_up(arena->copied_history_bytes, ARENA_ALIGNMENT) + arena->uncopied_history_bytes;
}
/* Returns the size of all memory in bytes. The copied history is there twice: as it is, and as it was before the last
 * step. */
static inline size_t tvi_arena_total_bytes(const tvi_arena *arena)
{
    return arena->bytes_outside_history + tvi_arena_history_bytes(arena) +
           tvi_arena_round_up(arena->copied_history_bytes, ARENA_ALIGNMENT);
}

/* Obtains memory of the size that was measured, all zeros, for the whole arena, and empties the arena, so that the
 * arrays can be allocated in this memory. The caller frees the memory. Returns NULL if memory is lacking. */
static inline void *tvi_arena_obtain_memory(tvi_arena *arena)
{
    const size_t bytes = tvi_arena_total_bytes(arena);
    char *memory = aligned_alloc(ARENA_ALIGNMENT, bytes);
    if (!memory) return NULL;
    memset(memory, 0, bytes);
    char *const history = memory + arena->bytes_outside_history;
    char *const uncopied_history = history + tvi_arena_round_up(arena->copied_history_bytes, ARENA_ALIGNMENT);
    *arena = (tvi_arena){.memory = memory, .history = history, .uncopied_history = uncopied_history};
    return memory;
}

/* Returns the next `bytes` bytes of a region, and counts them in *used. Returns NULL while the region has no
 * memory. */
static inline void *tvi_arena_reserve_piece(char *region, size_t *used, size_t bytes, size_t alignment)
{
    const size_t room = tvi_arena_round_up(bytes, alignment) + ARENA_GAP;
    char *piece = region ? region + *used : NULL;
    if (piece) ASAN_POISON_MEMORY_REGION(piece + bytes, room - bytes);
    *used += room;
    return piece;
}

/* Allocates an array of this size outside of the history. */
static inline void *tvi_arena_allocate(tvi_arena *arena, size_t bytes)
{
    return tvi_arena_reserve_piece(arena->memory, &arena->bytes_outside_history, bytes, ARENA_ALIGNMENT);
}

/* Allocates an array of this size in the copied history, which is restored after a failed step. */
static inline void *tvi_arena_allocate_copied(tvi_arena *arena, size_t bytes)
{
    return tvi_arena_reserve_piece(arena->history, &arena->copied_history_bytes, bytes, ARENA_COPIED_ALIGNMENT);
}

/* Allocates an array of this size in the uncopied history, which a failed step may leave changed. */
static inline void *tvi_arena_allocate_uncopied(tvi_arena *arena, size_t bytes)
{
    return tvi_arena_reserve_piece(arena->uncopied_history, &arena->uncopied_history_bytes, bytes, ARENA_ALIGNMENT);
}

/* Allocates an array of numbers outside of the history. */
static inline double *tvi_arena_allocate_doubles(tvi_arena *arena, size_t count)
{
    return tvi_arena_allocate(arena, count * sizeof(double));
}

/* Allocates `count` doubles for each pointer of the list, which NULL ends. */
static inline void tvi_arena_allocate_each(tvi_arena *arena, size_t count, double **const pointers[])
{
    for (; *pointers; pointers++) **pointers = tvi_arena_allocate_doubles(arena, count);
}

/* Copies a whole history, or clears it if from_or_null is NULL. It does not use memcpy if there are gaps, since the
 * address sanitizer would report that memcpy accesses them. */
ARENA_NO_SANITIZER static inline void tvi_arena_copy_history(char *to, const char *from_or_null, size_t bytes)
{
#ifdef ARENA_HAS_GAPS
    for (size_t i = 0; i < bytes; i++) ((volatile char *)to)[i] = from_or_null ? from_or_null[i] : 0;
#else
    if (from_or_null) memcpy(to, from_or_null, bytes);
    else memset(to, 0, bytes);
#endif
}

#endif
