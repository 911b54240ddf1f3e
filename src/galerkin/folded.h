/* folded.h - movements that are not the last of a step, of few unknowns with masses at eight nodes (few.h). What
 * multiplies the drives is one matrix for each unknown, scale matrix_ji weight_j: so fewer operations wait for each
 * other than where these are impulses, which are rounded once and enter all sums alike. What is rounded otherwise the
 * last movements of the step put right. */
#ifndef TVI_SRC_GALERKIN_FOLDED_H
#define TVI_SRC_GALERKIN_FOLDED_H

#include "galerkin/few.h"

/* What a step has of its first movements: where the unknowns would be without what drives them, or nearly, as it stands
 * in one number; and by how much the first movement changed them. */
typedef struct {
    _Alignas(64) few_vector origin[GALERKIN_FEWEST * OF_EIGHT], change[GALERKIN_FEWEST * OF_EIGHT];
} galerkin_folding;

JET_INLINE void set_origin(const galerkin_nodes *nodes, few_vector *origin)
{
    for (int k = 0; k < nodes->unknowns * OF_EIGHT; k++)
        origin[k] = BLOCK_OF(few_vector, nodes->high, k) + BLOCK_OF(few_vector, nodes->base, k);
}

/* Of the next step, by the impulses of this one, which add sum_j (1 - c_j + c_i) L_j there, and the drift. */
JET_INLINE void set_next_origin(const galerkin_nodes *nodes, const double *c, const double *drift, few_vector *origin)
{
    for (int u = 0; u < nodes->unknowns; u++) {
        const int first = u * OF_EIGHT;
        few_vector once = {0}, twice = {0};
        for (int k = 0; k < OF_EIGHT; k++) {
            const few_vector impulse = BLOCK_OF(few_vector, nodes->impulse, first + k);
            once += impulse;
            twice += (1 - BLOCK_OF(few_vector, c, k)) * impulse;
        }
        const double slope = nodes->scale[u] * sum_of_few(once), rise = drift[u] + nodes->scale[u] * sum_of_few(twice);
        for (int k = 0; k < OF_EIGHT; k++)
            origin[first + k] =
                (BLOCK_OF(few_vector, nodes->high, first + k) + rise) + BLOCK_OF(few_vector, c, k) * slope;
    }
}

/* nodes->impulse: the drives. */
JET_INLINE void follow_folded(const galerkin_nodes *nodes, const double *folded, const few_vector *origin)
{
    const double *drive = nodes->impulse;
    for (int u = 0; u < nodes->unknowns; u++, drive += 8, origin += OF_EIGHT, folded += galerkin_matrix_size(8)) {
        few_vector *x = &BLOCK_AT(few_vector, nodes->x, u * OF_EIGHT);
        sum_of_turned(folded + 8 * 8, (const few_vector *)drive, origin, x);
    }
}

/* Drives to impulses. */
JET_INLINE void weigh_drives(const galerkin_nodes *nodes)
{
    for (int k = 0; k < nodes->unknowns * OF_EIGHT; k++)
        BLOCK_AT(few_vector, nodes->impulse, k) *= BLOCK_OF(few_vector, nodes->weight, k % OF_EIGHT);
}

/* The squares of a change, as follow_few has them. */
JET_INLINE double squares_of(const galerkin_nodes *nodes, const few_vector *change)
{
    few_vector squares = {0};
    for (int k = 0; k < nodes->unknowns * OF_EIGHT; k++) {
        const few_vector relative = change[k] * nodes->inverse_size[k / OF_EIGHT];
        squares += relative * relative;
    }
    return sum_of_few(squares);
}

#endif
