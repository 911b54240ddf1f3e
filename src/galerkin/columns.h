/* columns.h - the sums over the nodes that a step ends with, of eight unknowns at a time, whose eight nodes are one
 * vector each (loops.c): turned over, so that the unknowns are the lanes, they need no shuffles. */
#ifndef TVI_SRC_GALERKIN_COLUMNS_H
#define TVI_SRC_GALERKIN_COLUMNS_H

#include "galerkin/pairs.h"

#ifdef JET_WIDE
/* Of pairs of vectors a, b: their even or odd numbers in turns; their halves of 256 bits, the even or the odd quarters
 * of each. */
#define TURN_EVEN(a, b)     JET_SHUFFLE_8(a, b, 0, 8, 2, 10, 4, 12, 6, 14)
#define TURN_ODD(a, b)      JET_SHUFFLE_8(a, b, 1, 9, 3, 11, 5, 13, 7, 15)
#define QUARTERS_EVEN(a, b) JET_SHUFFLE_8(a, b, 0, 1, 4, 5, 8, 9, 12, 13)
#define QUARTERS_ODD(a, b)  JET_SHUFFLE_8(a, b, 2, 3, 6, 7, 10, 11, 14, 15)

/* column[j] = lane j of each of the rows. */
JET_INLINE void turn_over(const jet_v8 row[8], jet_v8 column[8])
{
    for (int odd = 0; odd < 2; odd++) {
        jet_v8 pair[4];
        for (int k = 0; k < 4; k++)
            pair[k] = odd ? TURN_ODD(row[2 * k], row[2 * k + 1]) : TURN_EVEN(row[2 * k], row[2 * k + 1]);
        const jet_v8 first[] = {QUARTERS_EVEN(pair[0], pair[1]), QUARTERS_ODD(pair[0], pair[1])};
        const jet_v8 second[] = {QUARTERS_EVEN(pair[2], pair[3]), QUARTERS_ODD(pair[2], pair[3])};
        for (int k = 0; k < 2; k++) {
            column[2 * k + odd] = QUARTERS_EVEN(first[k], second[k]);
            column[4 + 2 * k + odd] = QUARTERS_ODD(first[k], second[k]);
        }
    }
}

/* sum + low = sum_j term(j), compensated, in two chains, which do not wait for each other. */
#define SUM_OF_COLUMNS(sum, low, term)                                                                                 \
    {                                                                                                                  \
        jet_v8 total[2], lost[2] = {{0}};                                                                              \
        for (int j = 0; j < 8; j++) {                                                                                  \
            const jet_v8 one = term;                                                                                   \
            if (j < 2) total[j] = one;                                                                                 \
            else add_two_sum_of_jet_v8(&total[j % 2], &lost[j % 2], &one);                                             \
        }                                                                                                              \
        add_two_sum_of_jet_v8(&total[0], &lost[0], &total[1]);                                                         \
        lost[0] += lost[1];                                                                                            \
        *(jet_v8 *)(sum) = total[0] + lost[0];                                                                         \
        *(jet_v8 *)(low) = lost[0] - (*(jet_v8 *)(sum)-total[0]);                                                      \
    }

/* Of the unknowns from u on; the sums have room for eight. */
JET_INLINE void sum_columns(const galerkin_weights *weights, const double *impulses, int u, int unknowns,
                            const galerkin_sums *sums)
{
    jet_v8 row[8], L[8], last = {0};
    for (int i = 0; i < 8; i++) row[i] = *(const jet_v8 *)(impulses + 8 * (u + i < unknowns ? u + i : unknowns - 1));
    turn_over(row, L);
    for (int j = 0; j < 8; j++) last += weights->last[j] * L[j];
    SUM_OF_COLUMNS(sums->once + u, sums->once_low + u, L[j])
    SUM_OF_COLUMNS(sums->twice + u, sums->twice_low + u, weights->pair[j * OF_PAIR + 1] * L[j])
    *(jet_v8 *)(sums->last + u) = JET_ABS(jet_v8, last);
    *(jet_v8 *)(sums->reach + u) = JET_ABS(jet_v8, L[0]) + JET_ABS(jet_v8, L[POINTS_OF(weights) - 1]);
}
#endif

#endif
