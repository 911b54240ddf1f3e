/* arena.h - all memory of an integrator, in one piece. The layout is walked twice: first to measure (base NULL), then
 * to hand out. */
#ifndef TVI_SRC_ARENA_H
#define TVI_SRC_ARENA_H

#include <stddef.h>

typedef struct {
    char *base;
    size_t used;
} tvi_arena;

enum { ARENA_ALIGNMENT = 64 };

static inline void *tvi_arena_take(tvi_arena *arena, size_t bytes)
{
    void *piece = arena->base ? arena->base + arena->used : NULL;
    arena->used += (bytes + ARENA_ALIGNMENT - 1) / ARENA_ALIGNMENT * ARENA_ALIGNMENT;
    return piece;
}

static inline double *tvi_arena_doubles(tvi_arena *arena, size_t count)
{
    return tvi_arena_take(arena, count * sizeof(double));
}

#endif
