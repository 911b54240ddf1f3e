/* arena.h - all memory of an integrator, in one piece. The layout is walked twice: first to measure (base NULL), then
 * to hand out. With the address sanitizer, a gap that nobody may touch follows each piece. */
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

/* What one step leaves to the next stands apart, in one region of its own: the history. All zeros are the history of no
 * step, so that whoever owns the memory can mark, undo, forget and save it without knowing what it means. At its end
 * stand pieces that are not marked, and that undoing the last step does not touch: what is set where a run begins, and
 * those that steps fill in turns. The rest of the history knows which: a step writes into one that nobody reads. */
typedef struct tvi_block tvi_block;
typedef struct {
    char *base, *history, *turns;
    size_t used, marked, in_turns; /* of what the history has before those pieces, and of them */
    const tvi_block *blocks;       /* block.h */
} tvi_arena;

/* Of what is marked pieces stand closer, since each step copies it. */
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

/* Of the history, */
static inline size_t tvi_arena_remembered(const tvi_arena *arena)
{
    return tvi_arena_rounded(arena->marked, ARENA_ALIGNMENT) + arena->in_turns;
}
/* and of all memory, which has what is marked once more, as it was before. */
static inline size_t tvi_arena_bytes(const tvi_arena *arena)
{
    return arena->used + tvi_arena_remembered(arena) + tvi_arena_rounded(arena->marked, ARENA_ALIGNMENT);
}

/* Memory for all that was measured, zeros, which is to be freed; then the arena hands it out. NULL without memory. */
static inline void *tvi_arena_open(tvi_arena *arena)
{
    const size_t bytes = tvi_arena_bytes(arena);
    char *memory = aligned_alloc(ARENA_ALIGNMENT, bytes);
    if (!memory) return NULL;
    memset(memory, 0, bytes);
    char *const history = memory + arena->used;
    char *const turns = history + tvi_arena_rounded(arena->marked, ARENA_ALIGNMENT);
    *arena = (tvi_arena){.base = memory, .history = history, .turns = turns};
    return memory;
}

/* The piece of so many bytes at region + used; NULL where there is no region. */
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

/* One of the pieces that steps fill in turns, or leave alone. */
static inline void *tvi_arena_turn(tvi_arena *arena, size_t bytes)
{
    return tvi_arena_cut(arena->turns, &arena->in_turns, bytes, ARENA_ALIGNMENT);
}

static inline double *tvi_arena_doubles(tvi_arena *arena, size_t count)
{
    return tvi_arena_take(arena, count * sizeof(double));
}

/* to = from, or zeros where that is NULL: a whole history, which has gaps that memcpy must not touch. */
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
