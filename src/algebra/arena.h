/* arena.h - Hands out the memory of an integrator from one piece. The layout is walked twice: first to measure, with
 * base NULL, then to hand out. With the address sanitizer a gap that may not be accessed follows each piece. */
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

/* The arena. The history is a region of its own, which holds all that one step leaves to the next. All zeros are the
 * history of no step, so that the owner of the memory can mark, undo, clear and save it without knowing its contents.
 * At the end of the history stand the rings. They are not marked, and undoing a step leaves them alone. They hold what
 * is set at the start of a run, and buffers that steps fill in turn; the marked history says which buffer is the
 * current one. */
typedef struct tvi_block tvi_block;
typedef struct {
    char *base, *history, *rings;
    /* Bytes so far: of the rest of the memory, of the marked history, and of the rings. */
    size_t used, marked, ring_bytes;
    const tvi_block *blocks; /* block.h */
} tvi_arena;

/* The alignment of pieces. Marked pieces stand closer, since each step copies them. */
enum { ARENA_ALIGNMENT = 64, ARENA_MARKED_ALIGNMENT = 16 };

#ifdef ARENA_HAS_GAPS
#include <sanitizer/asan_interface.h>
enum { ARENA_GAP = ARENA_ALIGNMENT };
#define ARENA_UNCHECKED JET_UNCHECKED
#else
enum { ARENA_GAP = 0 };
#define ASAN_POISON_MEMORY_REGION(address, bytes) ((void)(address), (void)(bytes))
#define ARENA_UNCHECKED
#endif

static inline size_t tvi_arena_rounded(size_t bytes, size_t alignment)
{
    return (bytes + alignment - 1) / alignment * alignment;
}

/* The bytes of the history. */
static inline size_t tvi_arena_history_bytes(const tvi_arena *arena)
{
    return tvi_arena_rounded(arena->marked, ARENA_ALIGNMENT) + arena->ring_bytes;
}
/* All bytes. The marked history stands there twice, now and as it was before the last step. */
static inline size_t tvi_arena_bytes(const tvi_arena *arena)
{
    return arena->used + tvi_arena_history_bytes(arena) + tvi_arena_rounded(arena->marked, ARENA_ALIGNMENT);
}

/* Allocates zeros for all that was measured, from which the arena then hands out. The memory is to be freed. NULL
 * without memory. */
static inline void *tvi_arena_open(tvi_arena *arena)
{
    const size_t bytes = tvi_arena_bytes(arena);
    char *memory = aligned_alloc(ARENA_ALIGNMENT, bytes);
    if (!memory) return NULL;
    memset(memory, 0, bytes);
    char *const history = memory + arena->used;
    char *const rings = history + tvi_arena_rounded(arena->marked, ARENA_ALIGNMENT);
    *arena = (tvi_arena){.base = memory, .history = history, .rings = rings};
    return memory;
}

/* The piece of `bytes` bytes at region + used; NULL if there is no region. */
static inline void *tvi_arena_cut(char *region, size_t *used, size_t bytes, size_t alignment)
{
    const size_t room = tvi_arena_rounded(bytes, alignment) + ARENA_GAP;
    char *piece = region ? region + *used : NULL;
    if (piece) ASAN_POISON_MEMORY_REGION(piece + bytes, room - bytes);
    *used += room;
    return piece;
}

static inline void *tvi_arena_take(tvi_arena *arena, size_t bytes)
{
    return tvi_arena_cut(arena->base, &arena->used, bytes, ARENA_ALIGNMENT);
}

static inline void *tvi_arena_history(tvi_arena *arena, size_t bytes)
{
    return tvi_arena_cut(arena->history, &arena->marked, bytes, ARENA_MARKED_ALIGNMENT);
}

/* Takes a piece of the rings. */
static inline void *tvi_arena_ring(tvi_arena *arena, size_t bytes)
{
    return tvi_arena_cut(arena->rings, &arena->ring_bytes, bytes, ARENA_ALIGNMENT);
}

static inline double *tvi_arena_doubles(tvi_arena *arena, size_t count)
{
    return tvi_arena_take(arena, count * sizeof(double));
}

/* Copies a whole history, or clears it if `from` is NULL. The gaps of a history must not be touched by memcpy. */
ARENA_UNCHECKED static inline void tvi_arena_copy(char *to, const char *from, size_t bytes)
{
#ifdef ARENA_HAS_GAPS
    for (size_t i = 0; i < bytes; i++) ((volatile char *)to)[i] = from ? from[i] : 0;
#else
    if (from) memcpy(to, from, bytes);
    else memset(to, 0, bytes);
#endif
}

#endif
