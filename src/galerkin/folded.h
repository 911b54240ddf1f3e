/* folded.h - movements that are not the last of a step, of few unknowns at eight nodes, which are one vector. What
 * multiplies the drives is one matrix for each unknown, scale matrix_ji weight_j: so fewer operations wait for each
 * other than where these are impulses (few.h), which are rounded once and enter all sums alike. What is rounded
 * otherwise the last movements of the step put right. Shorter vectors would have to read twice as many rows. */
#ifndef TVI_SRC_GALERKIN_FOLDED_H
#define TVI_SRC_GALERKIN_FOLDED_H

#include "galerkin/few.h"

/* What a step has of its first movements: where the unknowns would be without what drives them, or nearly, as it stands
 * in one number; and by how much the first movement changed them. */
typedef struct {
    _Alignas(64) jet_v8 origin[GALERKIN_FEWEST], change[GALERKIN_FEWEST];
} galerkin_folding;

JET_INLINE void set_origin(const galerkin_nodes *nodes, jet_v8 *origin)
{
    for (int u = 0; u < nodes->unknowns; u++)
        origin[u] = BLOCK_OF(jet_v8, nodes->high, u) + BLOCK_OF(jet_v8, nodes->base, u);
}

/* nodes->impulse: the drives. */
JET_INLINE void follow_folded(const galerkin_nodes *nodes, const double *folded, const jet_v8 *origin)
{
    const double *drive = nodes->impulse;
    if (!IN_REGISTER) LEAVE_REGISTERS(drive);
    for (int u = 0; u < nodes->unknowns; u++, drive += 8, folded += galerkin_matrix_size(8)) {
        jet_v8 sum[CHAINS] = {origin[u]};
        if (IN_REGISTER) {
            sum_of_turned((const jet_v8 *)(folded + 8 * 8), (const jet_v8 *)drive, &sum[1]);
        } else {
            for (int j = 0; j < 8; j++) sum[j % CHAINS] += BLOCK_OF(jet_v8, folded, j) * drive[j];
            sum[0] += sum[2];
            sum[1] += sum[3];
        }
        BLOCK_AT(jet_v8, nodes->x, u) = sum[0] + sum[1];
    }
}

/* Drives to impulses. */
JET_INLINE void weigh_drives(const galerkin_nodes *nodes)
{
    for (int u = 0; u < nodes->unknowns; u++) BLOCK_AT(jet_v8, nodes->impulse, u) *= BLOCK_OF(jet_v8, nodes->weight, 0);
}

/* The squares of a change, as follow_few has them. */
JET_INLINE double squares_of(const galerkin_nodes *nodes, const jet_v8 *change)
{
    jet_v8 squares = {0};
    for (int u = 0; u < nodes->unknowns; u++) {
        const jet_v8 relative = change[u] * nodes->inverse_size[u];
        squares += relative * relative;
    }
    return sum_of_jet_v8(squares);
}

#endif
