/* loosen.h - the stiffest springs, solved exactly in each pass (springs.h); read by loops.c. */
#ifndef TVI_SRC_GALERKIN_LOOSEN_H
#define TVI_SRC_GALERKIN_LOOSEN_H

#include "galerkin/lanes.h"

/* In generated code a few unknowns have a known number of modes, of which some may be 0 (springs.c). */
#ifdef JET_EMITTED
#define MODES_OF(springs, unknowns)                                                                                    \
    ((unknowns) > GALERKIN_FEWEST && (unknowns) <= GALERKIN_FEW ? GALERKIN_MODES(unknowns) : (springs)->count)
#else
#define MODES_OF(springs, unknowns) ((springs)->count)
#endif

#define SET_R(V, blocks)                                                                                               \
    for (int b = 0; b < (blocks)*unknowns; b++) BLOCK_AT(V, r, b) = BLOCK_OF(V, x, b) - BLOCK_OF(V, r, b);

/* v . M r of a mode. */
#define SET_PART(V, blocks)                                                                                            \
    for (int b = 0; b < (blocks); b++) {                                                                               \
        V sum[2] = {0};                                                                                                \
        for (int u = 0; u < unknowns; u++) sum[u % 2] += dual[u] * BLOCK_OF(V, r + u * lanes, b);                      \
        BLOCK_AT(V, part, b) = sum[0] + sum[1];                                                                        \
    }

/* (D - 1) of that. */
#define SET_MORE(V, blocks)                                                                                            \
    for (int b = 0; b < (blocks); b++) {                                                                               \
        V sum[CHAINS] = {0};                                                                                           \
        for (int j = 0; j < lanes; j++) sum[j % CHAINS] += BLOCK_OF(V, table + j * lanes, b) * part[j];                \
        BLOCK_AT(V, more, b) = (sum[0] + sum[1]) + (sum[2] + sum[3]);                                                  \
    }

#define ADD_MORE(V, blocks)                                                                                            \
    for (int u = 0; u < unknowns; u++)                                                                                 \
        for (int b = 0; b < (blocks); b++) {                                                                           \
            V place = BLOCK_OF(V, x + u * lanes, b);                                                                   \
            for (int k = 0; k < count; k++) place += mode[k * unknowns + u] * BLOCK_OF(V, more + k * lanes, b);        \
            BLOCK_AT(V, x + u * lanes, b) = place;                                                                     \
        }

/* Behind a movement; r: where it began. */
JET_INLINE void loosen_lanes(const galerkin_nodes *nodes, const galerkin_springs *springs, int lanes)
{
    const int unknowns = nodes->unknowns, count = MODES_OF(springs, unknowns);
    const double *mode = springs->mode;
    double *x = nodes->x, *r = springs->r;
    ALL_LANES(lanes, SET_R)
    for (int k = 0; k < count; k++) {
        const double *dual = springs->dual + k * unknowns;
        double *part = springs->part + k * lanes;
        ALL_LANES(lanes, SET_PART)
    }
    for (int k = 0; k < count; k++) {
        const double *table = springs->table + k * lanes * lanes, *part = springs->part + k * lanes;
        double *more = springs->more + k * lanes;
        LEAVE_REGISTERS(part);
        ALL_LANES(lanes, SET_MORE)
    }
    const double *more = springs->more;
    ALL_LANES(lanes, ADD_MORE)
}

BY_LANES(void, , loosen, (const galerkin_nodes *nodes, const galerkin_springs *springs), nodes, springs)

#endif
