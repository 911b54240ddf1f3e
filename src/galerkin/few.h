/* few.h - a movement of few unknowns at eight nodes, which are one vector (loops.c). So few that each operation waits
 * for the one before it would wait for the impulses, too, where these are stored: here they are read in their register.
 * Of more unknowns none waits, and a factor in memory is one operation less. */
#ifndef TVI_SRC_GALERKIN_FEW_H
#define TVI_SRC_GALERKIN_FEW_H

#include "galerkin/lanes.h"

#ifdef __AVX512F__
#define ALL_OF_LANE(x, j) JET_SHUFFLE_8(x, x, j, j, j, j, j, j, j, j)
#define TERMS(j, next)    (row[j] * ALL_OF_LANE(impulse, j) + row[next] * ALL_OF_LANE(impulse, next))

/* What move_lanes does; false: they are not few. */
JET_INLINE bool move_few(const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[],
                         int lanes, double *moved)
{
    const double *scale = nodes->scale, *inverse_size = nodes->inverse_size;
    const jet_v8 *row = (const jet_v8 *)matrix, *high = (const jet_v8 *)nodes->high,
                 *base = (const jet_v8 *)nodes->base;
    const jet_v8 weight = *(const jet_v8 *)nodes->weight;
    jet_v8 squares = {0}, *x = (jet_v8 *)nodes->x, *impulses = (jet_v8 *)nodes->impulse;
    if (lanes != 8 || nodes->unknowns > FEW || nodes->moving < nodes->unknowns) return false;
    for (int u = 0; u < nodes->unknowns; u++) {
        const jet_v8 impulse = weight * *(const jet_v8 *)(drives + slot[u] * 8);
        const jet_v8 sum = (TERMS(0, 4) + TERMS(2, 6)) + (TERMS(1, 5) + TERMS(3, 7));
        const jet_v8 place = high[u] + (base[u] + scale[u] * sum), change = (place - x[u]) * inverse_size[u];
        squares += change * change;
        x[u] = place;
        impulses[u] = impulse;
    }
    *moved = sum_of_jet_v8(squares);
    return true;
}
#else
JET_INLINE bool move_few(const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[],
                         int lanes, double *moved)
{
    (void)nodes, (void)matrix, (void)drives, (void)slot, (void)lanes, (void)moved;
    return false;
}
#endif

#endif
