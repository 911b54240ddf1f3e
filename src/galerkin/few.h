/* few.h - a movement of few unknowns at eight nodes, which are one vector (loops.c). So few that each operation waits
 * for the one before it would wait for the impulses, too, where these are stored: here they are read in their register.
 * Of more unknowns none waits, and a factor in memory is one operation less.
 *
 * Lane i of what is turned by k was lane i ^ k, and i ^ k runs through all nodes as k does:
 *   sum_j matrix_ji L_j = sum_k turned_ki L_(i^k),  turned_ki = matrix_(i^k)i.
 * Turns by 1 wait least; the others are as dear as products. */
#ifndef TVI_SRC_GALERKIN_FEW_H
#define TVI_SRC_GALERKIN_FEW_H

#include "galerkin/lanes.h"

/* Whether they are; without such vectors never. */
#ifdef JET_WIDE
#include <immintrin.h>
#define ARE_ONE_VECTOR(lanes) ((lanes) == 8)
#else
#define ARE_ONE_VECTOR(lanes) false
#endif
/* Generated code is of the machine it was generated on, which may read sooner what was stored. */
#ifdef JET_EMITTED
#define IN_REGISTER GALERKIN_IN_REGISTER
#else
#define IN_REGISTER true
#endif
#define ARE_FEW(nodes, lanes)                                                                                          \
    (ARE_ONE_VECTOR(lanes) && (nodes)->unknowns <= GALERKIN_FEWEST && (nodes)->moving == (nodes)->unknowns)
#define ARE_TURNED(nodes, lanes) (IN_REGISTER && ARE_FEW(nodes, lanes))

#define TURNED_BY_1(x) JET_SHUFFLE_8(x, x, 1, 0, 3, 2, 5, 4, 7, 6)
#define TURNED_BY_2(x) JET_SHUFFLE_8(x, x, 2, 3, 0, 1, 6, 7, 4, 5)
#define TURNED_BY_4(x) JET_SHUFFLE_8(x, x, 4, 5, 6, 7, 0, 1, 2, 3)
#define TURNED_BY_6(x) JET_SHUFFLE_8(x, x, 6, 7, 4, 5, 2, 3, 0, 1)

/* The sum over k, what is known last at the end of its chain. */
JET_INLINE void sum_of_turned(const jet_v8 *turned, const jet_v8 *of, jet_v8 *sum)
{
    const jet_v8 impulse = *of, by_2 = TURNED_BY_2(impulse), by_4 = TURNED_BY_4(impulse), by_6 = TURNED_BY_6(impulse);
    const jet_v8 by_1 = TURNED_BY_1(impulse), by_3 = TURNED_BY_1(by_2), by_5 = TURNED_BY_1(by_4);
    const jet_v8 one = (turned[0] * impulse + turned[1] * by_1) + turned[3] * by_3;
    const jet_v8 two = turned[2] * by_2 + turned[5] * by_5, three = turned[4] * by_4 + turned[7] * TURNED_BY_1(by_6);
    *sum = (one + turned[6] * by_6) + (two + three);
}

#define ALL_OF_LANE(x, j) JET_SHUFFLE_8(x, x, j, j, j, j, j, j, j, j)
#define TERMS(j, next)    (row[j] * ALL_OF_LANE(impulse, j) + row[next] * ALL_OF_LANE(impulse, next))

/* The sum over j: passes that do more than a field, or that an interpreter makes, gain nothing by turns. */
JET_INLINE void sum_of_lanes(const jet_v8 *row, const jet_v8 *of, jet_v8 *sum)
{
    const jet_v8 impulse = *of;
    *sum = (TERMS(0, 4) + TERMS(2, 6)) + (TERMS(1, 5) + TERMS(3, 7));
}

/* One unknown by the sum of its impulses; the squares of its movement are added. */
JET_INLINE void follow_one(const galerkin_nodes *nodes, int u, const jet_v8 *sum, jet_v8 *squares)
{
    jet_v8 *x = (jet_v8 *)nodes->x;
    const jet_v8 high = ((const jet_v8 *)nodes->high)[u], base = ((const jet_v8 *)nodes->base)[u];
    const jet_v8 place = high + (base + nodes->scale[u] * *sum);
    const jet_v8 change = (place - x[u]) * nodes->inverse_size[u];
    *squares += change * change;
    x[u] = place;
}

/* What follow_lanes does, but for the sum of the squares. matrix: with what is turned behind it. */
JET_INLINE void follow_few(const galerkin_nodes *nodes, const double *matrix, jet_v8 *squares)
{
    *squares = (jet_v8){0};
    for (int u = 0; u < nodes->unknowns; u++) {
        jet_v8 sum;
        sum_of_turned((const jet_v8 *)(matrix + 8 * 8), (const jet_v8 *)nodes->impulse + u, &sum);
        follow_one(nodes, u, &sum, squares);
    }
}

/* Whether none has moved: known before the sum would be. */
JET_INLINE bool are_at_rest(jet_v8 squares)
{
#ifdef JET_WIDE
    return _mm512_test_epi64_mask((__m512i)squares, (__m512i)squares) == 0;
#else
    return sum_of_jet_v8(squares) == 0;
#endif
}

/* What move_lanes does. */
JET_INLINE double move_few(const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[])
{
    const jet_v8 weight = *(const jet_v8 *)nodes->weight;
    jet_v8 squares = {0}, *impulses = (jet_v8 *)nodes->impulse;
    for (int u = 0; u < nodes->unknowns; u++) {
        const jet_v8 impulse = weight * *(const jet_v8 *)(drives + slot[u] * 8);
        jet_v8 sum;
        sum_of_lanes((const jet_v8 *)matrix, &impulse, &sum);
        follow_one(nodes, u, &sum, &squares);
        impulses[u] = impulse;
    }
    return sum_of_jet_v8(squares);
}

#endif
