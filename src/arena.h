/* arena.h - all memory of an integrator, in one piece. The layout is walked twice: first to measure (base NULL), then
 * to hand out. */
#ifndef TVI_SRC_ARENA_H
#define TVI_SRC_ARENA_H

#include <stddef.h>

/* What one step leaves to the next stands apart, in one region of its own: the history. All zeros are the history of no
 * step, so that whoever owns the memory can mark, undo, forget and save it without knowing what it means. */
typedef struct {
    char *base, *history;
    size_t used, remembered;
} tvi_arena;

enum { ARENA_ALIGNMENT = 64 };

static inline size_t tvi_arena_round(size_t bytes)
{
    return (bytes + ARENA_ALIGNMENT - 1) / ARENA_ALIGNMENT * ARENA_ALIGNMENT;
}

static inline void *tvi_arena_take(tvi_arena *arena, size_t bytes)
{
    void *piece = arena->base ? arena->base + arena->used : NULL;
    arena->used += tvi_arena_round(bytes);
    return piece;
}

static inline void *tvi_arena_history(tvi_arena *arena, size_t bytes)
{
    void *piece = arena->history ? arena->history + arena->remembered : NULL;
    arena->remembered += tvi_arena_round(bytes);
    return piece;
}

static inline double *tvi_arena_doubles(tvi_arena *arena, size_t count)
{
    return tvi_arena_take(arena, count * sizeof(double));
}

#endif
