/* vector.h - Defines loops that apply a computation to all numbers of an array, in vectors. The body of a loop is a
 * macro, such as the recurrence of an operation (rule.h), and is written once, for a vector type V. The loops process
 * the numbers of a run (adjacent slots of one operation) in vectors of the machine's size, then in shorter ones, down
 * to single numbers. Sums over orders j stay in registers.
 *
 * The rules and the sweeps are compiled once for each instruction set JET_ISA (base, avx2, avx512);
 * jet_choose_sweeps_for_processor (isa.c) chooses the set at run time. Vector types are an extension of gcc and
 * clang. */
#ifndef TVI_AD_VECTOR_H
#define TVI_AD_VECTOR_H

#include "compiler.h"

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>

/* JET_WIDE is defined if the machine's vectors hold eight numbers. */
#ifdef __AVX512F__
#define JET_WIDE
#endif

typedef double jet_v8 JET_VECTOR(double, 8);
typedef double jet_v4 JET_VECTOR(double, 4);
typedef double jet_v2 JET_VECTOR(double, 2);
typedef double jet_v1;

/* The results of comparisons of vectors: the bits of each lane are all set where the comparison holds, else all 0.
 * JET_CHOOSE takes each lane from the vector `yes` where the mask is set, else from the vector `no`. */
typedef long long jet_mask_of_jet_v8 JET_VECTOR(long long, 8);
typedef long long jet_mask_of_jet_v4 JET_VECTOR(long long, 4);
typedef long long jet_mask_of_jet_v2 JET_VECTOR(long long, 2);
/* The widest vector that the instruction set has. */
#ifdef JET_WIDE
typedef jet_v8 jet_widest;
typedef jet_mask_of_jet_v8 jet_mask_of_jet_widest;
#elif defined(__AVX__)
typedef jet_v4 jet_widest;
typedef jet_mask_of_jet_v4 jet_mask_of_jet_widest;
#else
typedef jet_v2 jet_widest;
typedef jet_mask_of_jet_v2 jet_mask_of_jet_widest;
#endif
#define JET_MASK(V) jet_mask_of_##V
#define JET_CHOOSE(V, mask, yes, no)                                                                                   \
    ((V)(((JET_MASK(V))(yes) & (JET_MASK(V))(mask)) | ((JET_MASK(V))(no) & ~(JET_MASK(V))(mask))))
#define JET_ABS(V, x) ((V)((JET_MASK(V))(x)&LLONG_MAX))

/* The following macros call BODY(V, S) for consecutive vectors of an array. `here` is the index of the vector's first
 * number. S is a macro with which the body reads a series (rule.h). */
#define JET_BLOCKS_8(width, BODY, S)                                                                                   \
    for (; here + 8 <= (width); here += 8) BODY(jet_v8, S)
#define JET_BLOCKS_4(width, BODY, S)                                                                                   \
    for (; here + 4 <= (width); here += 4) BODY(jet_v4, S)
#define JET_BLOCKS_2(width, BODY, S)                                                                                   \
    for (; here + 2 <= (width); here += 2) BODY(jet_v2, S)
#define JET_BLOCKS_1(width, BODY, S)                                                                                   \
    for (; here < (width); here++) BODY(jet_v1, S)
#ifdef JET_WIDE
#define JET_WIDE_BLOCKS(width, BODY, S)                                                                                \
    JET_BLOCKS_8(width, BODY, S)                                                                                       \
    JET_BLOCKS_4(width, BODY, S)
#elif defined(__AVX__)
#define JET_WIDE_BLOCKS JET_BLOCKS_4
#else
#define JET_WIDE_BLOCKS(width, BODY, S)
#endif
#define JET_BLOCKS(width, BODY, S)                                                                                     \
    do {                                                                                                               \
        int here = 0;                                                                                                  \
        JET_WIDE_BLOCKS(width, BODY, S)                                                                                \
        JET_BLOCKS_2(width, BODY, S)                                                                                   \
        JET_BLOCKS_1(width, BODY, S)                                                                                   \
    } while (0)

/* Calls BODY for a width that is a multiple of 8. If eight numbers are two vectors, the loop is unrolled, as the
 * loop itself would cost as much as its body. */
#ifdef JET_WIDE
#define JET_BLOCKS_OF_8(width, BODY, S)                                                                                \
    for (int here = 0; here < (width); here += 8) BODY(jet_v8, S)
#elif defined(__AVX__)
#define JET_BLOCKS_OF_8(width, BODY, S) JET_UNROLL(4) for (int here = 0; here < (width); here += 4) BODY(jet_v4, S)
#else
#define JET_BLOCKS_OF_8(width, BODY, S)                                                                                \
    for (int here = 0; here < (width); here += 2) BODY(jet_v2, S)
#endif

/* Loads a vector of the numbers of x at these indices. If the indices are adjacent, it is a single load. */
#define JET_GATHER(V, x, index)     (JET_IN_A_ROW(V, index) ? *(const V *)((x) + (index)[0]) : JET_GATHER_##V(x, index))
#define JET_GATHER_jet_v1(x, index) ((x)[(index)[0]])
#define JET_GATHER_jet_v2(x, index) ((jet_v2){JET_PAIR_AT(x, index)})
#define JET_GATHER_jet_v4(x, index) ((jet_v4){JET_PAIR_AT(x, index), JET_PAIR_AT(x, (index) + 2)})
#define JET_GATHER_jet_v8(x, index)                                                                                    \
    ((jet_v8){JET_PAIR_AT(x, index), JET_PAIR_AT(x, (index) + 2), JET_PAIR_AT(x, (index) + 4),                         \
              JET_PAIR_AT(x, (index) + 6)})
#define JET_PAIR_AT(x, index)  (x)[(index)[0]], (x)[(index)[1]]
#define JET_IN_A_ROW(V, index) jet_are_indices_adjacent((int)(sizeof(V) / sizeof(double)), index)
JET_INLINE bool jet_are_indices_adjacent(int count, const int index[])
{
    bool is_row = true;
    for (int i = 1; i < count; i++) is_row &= index[i] == index[0] + i;
    return is_row;
}

/* Coefficient j of a series x, for the vector that begins at the number `here`. JET_D_AT and JET_D_OF take those of a
 * tangent x. JET_AT and JET_D_AT can be assigned to, JET_OF and JET_D_OF are only read. */
#define JET_AT(V, x, j)   (*(V *)((x) + stride * (size_t)(j) + here))
#define JET_OF(V, x, j)   (*(const V *)((x) + stride * (size_t)(j) + here))
#define JET_D_AT(V, x, j) (*(V *)((x) + dstride * (size_t)(j) + here))
#define JET_D_OF(V, x, j) (*(const V *)((x) + dstride * (size_t)(j) + here))
/* Coefficient j of a series with one lane, which serves all lanes of a tangent. */
#define JET_ONE_OF(V, x, j) ((x)[stride * (size_t)(j)])

/* Computes sum += sum_{j=from}^{to} term(j), in two chains of additions, which need not wait for each other. */
#define JET_SUM(V, sum, from, to, term)                                                                                \
    do {                                                                                                               \
        V second = {0};                                                                                                \
        int next = (from);                                                                                             \
        for (; next < (to); next += 2) JET_TWO_TERMS(sum, second, next, next + 1, term)                                \
        if (next == (to)) {                                                                                            \
            const int j = next;                                                                                        \
            sum += term;                                                                                               \
        }                                                                                                              \
        sum += second;                                                                                                 \
    } while (0)
#define JET_TWO_TERMS(sum, odd, one, other, term)                                                                      \
    {                                                                                                                  \
        {                                                                                                              \
            const int j = one;                                                                                         \
            sum += term;                                                                                               \
        }                                                                                                              \
        {                                                                                                              \
            const int j = other;                                                                                       \
            odd += term;                                                                                               \
        }                                                                                                              \
    }

/* Executes the statement for j = from..to. Adjoint rules use it, whose statements add to a different order for each
 * j. */
#define JET_EACH(from, to, statement)                                                                                  \
    for (int j = (from), last = (to); j <= last; j++) statement

#endif
