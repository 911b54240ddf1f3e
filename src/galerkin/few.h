/* few.h - a movement of few unknowns at eight nodes, which are one vector or, in generated code, two (loops.c). So few
 * that each operation waits for the one before it would wait for the impulses, too, where these are stored: here they
 * are read in their registers. Of more unknowns none waits, and a factor in memory is one operation less.
 *
 * Lane i of what is turned by k was lane i ^ k, and i ^ k runs through all nodes as k does:
 *   sum_j matrix_ji L_j = sum_k turned_ki L_(i^k),  turned_ki = matrix_(i^k)i.
 * Turns by 1 wait least; the others are as dear as products of eight numbers, and nearly free beside those of four,
 * which another unit makes. */
#ifndef TVI_SRC_GALERKIN_FEW_H
#define TVI_SRC_GALERKIN_FEW_H

#include "galerkin/lanes.h"

/* The vectors of eight nodes, which need not be in registers. Whether one is zero is known before its sum would be. */
#ifdef JET_WIDE
#include <immintrin.h>
enum { OF_EIGHT = 1, HAS_EIGHT = true };
typedef jet_v8 few_vector;
JET_INLINE double sum_of_few(few_vector x) { return sum_of_jet_v8(x); }
JET_INLINE bool are_zero(few_vector x) { return _mm512_test_epi64_mask((__m512i)x, (__m512i)x) == 0; }
#else
enum { OF_EIGHT = 2 };
typedef jet_v4 few_vector;
JET_INLINE double sum_of_few(few_vector x) { return sum_of_jet_v4(x); }
#if defined(__AVX__) && defined(JET_EMITTED)
#include <immintrin.h>
enum { HAS_EIGHT = true };
JET_INLINE bool are_zero(few_vector x) { return _mm256_testz_si256((__m256i)x, (__m256i)x); }
#else
enum { HAS_EIGHT = false };
JET_INLINE bool are_zero(few_vector x) { return sum_of_few(x) == 0; }
#endif
#endif
#define ARE_EIGHT(lanes) (HAS_EIGHT && (lanes) == 8)
#define ARE_FEW(nodes, lanes)                                                                                          \
    (ARE_EIGHT(lanes) && (nodes)->unknowns <= GALERKIN_FEWEST && (nodes)->moving == (nodes)->unknowns)

/* sum = from, or nothing, + the sum over k, what is known last at the end of its chain. */
#ifdef JET_WIDE
#define TURNED_BY_1(x) JET_SHUFFLE_8(x, x, 1, 0, 3, 2, 5, 4, 7, 6)
#define TURNED_BY_2(x) JET_SHUFFLE_8(x, x, 2, 3, 0, 1, 6, 7, 4, 5)
#define TURNED_BY_4(x) JET_SHUFFLE_8(x, x, 4, 5, 6, 7, 0, 1, 2, 3)
#define TURNED_BY_6(x) JET_SHUFFLE_8(x, x, 6, 7, 4, 5, 2, 3, 0, 1)
JET_INLINE void sum_of_turned(const double *matrix, const few_vector *of, const few_vector *from, few_vector *sum)
{
    const jet_v8 *turned = (const jet_v8 *)matrix;
    const jet_v8 impulse = *of, by_2 = TURNED_BY_2(impulse), by_4 = TURNED_BY_4(impulse), by_6 = TURNED_BY_6(impulse);
    const jet_v8 by_1 = TURNED_BY_1(impulse), by_3 = TURNED_BY_1(by_2), by_5 = TURNED_BY_1(by_4);
    jet_v8 one = turned[0] * impulse;
    if (from) one += *from;
    one = (one + turned[1] * by_1) + turned[3] * by_3;
    const jet_v8 two = turned[2] * by_2 + turned[5] * by_5, three = turned[4] * by_4 + turned[7] * TURNED_BY_1(by_6);
    *sum = (one + turned[6] * by_6) + (two + three);
}
#else
/* Those of one half by those of each half in a chain of its own. */
#define TURNED(x, k) JET_SHUFFLE_4(x, x, 0 ^ k, 1 ^ k, 2 ^ k, 3 ^ k)
JET_INLINE void sum_of_turned(const double *matrix, const few_vector *of, const few_vector *from, few_vector *sum)
{
    enum { HALVES = 2, TURNS = 4 };
    const jet_v4 *turned = (const jet_v4 *)matrix;
    jet_v4 by[HALVES][TURNS], part[HALVES];
    for (int i = 0; i < HALVES; i++) {
        by[i][0] = of[i];
        by[i][1] = TURNED(of[i], 1);
        by[i][2] = TURNED(of[i], 2);
        by[i][3] = TURNED(of[i], 3);
    }
    for (int i = 0; i < HALVES; i++) {
        for (int j = 0; j < HALVES; j++) {
            const jet_v4 *row = turned + HALVES * TURNS * (i ^ j) + i;
            part[j] = row[0] * by[j][0];
            if (j == 0 && from) part[j] += from[i];
            for (int k = 1; k < TURNS; k++) part[j] += row[HALVES * k] * by[j][k];
        }
        sum[i] = part[0] + part[1];
    }
}
#endif

/* One unknown by the sum of its impulses; the squares of its movement are added. */
JET_INLINE void follow_one(const galerkin_nodes *nodes, int u, const few_vector *sum, few_vector *squares)
{
    for (int k = 0; k < OF_EIGHT; k++) {
        const int at = u * OF_EIGHT + k;
        few_vector *x = &BLOCK_AT(few_vector, nodes->x, at);
        const few_vector high = BLOCK_OF(few_vector, nodes->high, at), base = BLOCK_OF(few_vector, nodes->base, at);
        const few_vector place = high + (base + nodes->scale[u] * sum[k]);
        const few_vector change = (place - *x) * nodes->inverse_size[u];
        *squares += change * change;
        *x = place;
    }
}

/* What follow_lanes does, but for the sum of the squares. matrix: with what is turned behind it. */
JET_INLINE void follow_few(const galerkin_nodes *nodes, const double *matrix, few_vector *squares)
{
    *squares = (few_vector){0};
    for (int u = 0; u < nodes->unknowns; u++) {
        few_vector sum[OF_EIGHT];
        sum_of_turned(matrix + 8 * 8, &BLOCK_OF(few_vector, nodes->impulse, u * OF_EIGHT), NULL, sum);
        follow_one(nodes, u, sum, squares);
    }
}

#ifdef JET_WIDE
#define ALL_OF_LANE(x, j) JET_SHUFFLE_8(x, x, j, j, j, j, j, j, j, j)
#define TERMS(j, next)    (row[j] * ALL_OF_LANE(impulse, j) + row[next] * ALL_OF_LANE(impulse, next))

/* The sum over j: passes that do more than a field, or that an interpreter makes, gain nothing by turns. */
JET_INLINE void sum_of_lanes(const jet_v8 *row, const jet_v8 *of, jet_v8 *sum)
{
    const jet_v8 impulse = *of;
    *sum = (TERMS(0, 4) + TERMS(2, 6)) + (TERMS(1, 5) + TERMS(3, 7));
}

/* What move_lanes does, one unknown after the other: where one itself is what drives another, that has moved then. */
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

#endif
