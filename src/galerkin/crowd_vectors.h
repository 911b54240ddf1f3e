/* crowd_vectors.h - members in vectors: what the loops of crowd_loops.h are written with. For files that are compiled
 * once for each instruction set (ad/vector.h). */
#ifndef TVI_SRC_GALERKIN_CROWD_VECTORS_H
#define TVI_SRC_GALERKIN_CROWD_VECTORS_H

#include "galerkin/crowd_loops.h"
#include "rule.h"
#include "vector.h"

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

#define tvi_galerkin_crowd_begin JET_FOR_ISA(tvi_galerkin_crowd_begin)
#define tvi_galerkin_crowd_judge JET_FOR_ISA(tvi_galerkin_crowd_judge)

/* Row of [rows][width], at the block of members. */
#define ROW_AT(V, array, row) (*(V *)((array) + (size_t)(row)*width + here))
#define ROW_OF(V, array, row) (*(const V *)((array) + (size_t)(row)*width + here))

#define IS_MOVING(V) (*(const JET_MASK(V) *)(nodes->is_moving + here))

/* Declares `all`: not 0 where the mask holds for all members of the block. */
#if defined(__AVX512F__)
#define HOLDS_FOR_ALL(V, mask, all) const bool all = _mm512_test_epi64_mask((__m512i)(mask), (__m512i)(mask)) == 0xff;
#else
#define HOLDS_FOR_ALL(V, mask, all)                                                                                    \
    long long all = -1;                                                                                                \
    for (size_t m = 0; m < sizeof(V) / sizeof(double); m++) all &= (mask)[m];
#endif

/* As galerkin_crowd_loops has them. */
void tvi_galerkin_crowd_begin(const galerkin_crowd_nodes *nodes, const galerkin_crowd_passes *passes);
int tvi_galerkin_crowd_judge(const galerkin_crowd_nodes *nodes, const tvi_passes_rule *rule, int count,
                             const double moved[], const galerkin_crowd_passes *passes, bool *any_stuck);

#endif
