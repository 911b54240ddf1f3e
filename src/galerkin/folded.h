/* folded.h - movements of few unknowns that are not the last of a step. What multiplies their drives is one matrix for
 * each unknown, scale matrix_ji weight_j; so of the operations that wait for each other there are four less than of
 * those that impulses take (few.h), which are rounded once and enter all sums alike. The last movements of the step put
 * right what is rounded otherwise. */
#ifndef TVI_SRC_GALERKIN_FOLDED_H
#define TVI_SRC_GALERKIN_FOLDED_H

#include "galerkin/few.h"

/* What a step has of its first movements: where the unknowns would be without what drives them, or nearly, as it stands
 * in one number; and by how much the first movement changed them. */
typedef struct {
    _Alignas(64) double origin[GALERKIN_FEWEST * TVI_GALERKIN_MAX_LANES];
    _Alignas(64) double change[GALERKIN_FEWEST * TVI_GALERKIN_MAX_LANES];
} galerkin_folding;

#define SET_ORIGIN(V, blocks)                                                                                          \
    for (int k = 0; k < (blocks); k++) BLOCK_AT(V, origin, k) = BLOCK_OF(V, high, k) + BLOCK_OF(V, base, k);
JET_INLINE void set_origin(const galerkin_nodes *nodes, double *origin, int lanes)
{
    const double *high = nodes->high, *base = nodes->base;
    for (int u = 0; u < nodes->unknowns; u++, origin += lanes, high += lanes, base += lanes)
        ALL_LANES(lanes, SET_ORIGIN)
}

#define FOLLOW_FOLDED(V, blocks)                                                                                       \
    for (int k = 0; k < (blocks); k++) {                                                                               \
        V sum[CHAINS] = {BLOCK_OF(V, origin, k)};                                                                      \
        for (int j = 0; j < lanes; j++) sum[j % CHAINS] += BLOCK_OF(V, folded + j * lanes, k) * drive[j];              \
        BLOCK_AT(V, x, k) = (sum[0] + sum[1]) + (sum[2] + sum[3]);                                                     \
    }

/* nodes->impulse: the drives, [unknowns][lanes]. */
JET_INLINE void follow_folded(const galerkin_nodes *nodes, const double *folded, const double *origin, int lanes)
{
    const bool in_register = ARE_FEW(nodes, lanes);
    double *x = nodes->x, *drive = nodes->impulse;
    if (!in_register) LEAVE_REGISTERS(drive);
    for (int u = 0; u < nodes->unknowns; u++, x += lanes, origin += lanes, drive += lanes) {
        if (in_register) {
            jet_v8 sum;
            sum_of_turned((const jet_v8 *)(folded + 8 * 8), (const jet_v8 *)drive, &sum);
            *(jet_v8 *)x = *(const jet_v8 *)origin + sum;
        } else {
            ALL_LANES(lanes, FOLLOW_FOLDED)
        }
        folded += galerkin_matrix_size(lanes);
    }
}

/* Drives to impulses. */
#define WEIGH_DRIVE(V, blocks)                                                                                         \
    for (int k = 0; k < (blocks); k++) BLOCK_AT(V, impulse, k) *= BLOCK_OF(V, nodes->weight, k);
JET_INLINE void weigh_drives(const galerkin_nodes *nodes, int lanes)
{
    double *impulse = nodes->impulse;
    for (int u = 0; u < nodes->unknowns; u++, impulse += lanes) ALL_LANES(lanes, WEIGH_DRIVE)
}

/* y = x - y. */
#define SUBTRACT_FROM(V, blocks)                                                                                       \
    for (int k = 0; k < (blocks); k++) BLOCK_AT(V, y, k) = BLOCK_OF(V, x, k) - BLOCK_OF(V, y, k);
JET_INLINE void subtract_from(const double *x, double *y, int count, int lanes)
{
    for (int u = 0; u < count; u++, x += lanes, y += lanes) ALL_LANES(lanes, SUBTRACT_FROM)
}

/* Of changes, as follow_lanes returns them. */
#define SQUARES_OF(V, blocks)                                                                                          \
    {                                                                                                                  \
        V squares = {0};                                                                                               \
        for (int u = 0; u < nodes->unknowns; u++)                                                                      \
            for (int k = 0; k < (blocks); k++) {                                                                       \
                const V relative = BLOCK_OF(V, change + u * lanes, k) * nodes->inverse_size[u];                        \
                squares += relative * relative;                                                                        \
            }                                                                                                          \
        moved = sum_of_##V(squares);                                                                                   \
    }
JET_INLINE double squares_of(const galerkin_nodes *nodes, const double *change, int lanes)
{
    double moved;
    ALL_LANES(lanes, SQUARES_OF)
    return moved;
}

#endif
