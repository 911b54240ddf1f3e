/* batch_vectors.h - members in vectors: what the loops of batch_loops.h are written with. For files that are compiled
 * once for each instruction set (ad/vector.h). */
#ifndef TVI_SRC_GALERKIN_BATCH_VECTORS_H
#define TVI_SRC_GALERKIN_BATCH_VECTORS_H

#include "galerkin/batch_loops.h"
#include "rule.h"
#include "vector.h"

#ifdef JET_WIDE
#include <immintrin.h>
#endif

#define tvi_galerkin_batch_begin JET_FOR_ISA(tvi_galerkin_batch_begin)
#define tvi_galerkin_batch_judge JET_FOR_ISA(tvi_galerkin_batch_judge)

/* Row of [rows][width], at the block of members. */
#define ROW_AT(V, array, row) (*(V *)((array) + (size_t)(row)*width + here))
#define ROW_OF(V, array, row) (*(const V *)((array) + (size_t)(row)*width + here))

/* Which members of the block: what comparisons give, in registers of masks where there are such. */
#ifdef JET_WIDE
typedef __mmask8 which_of_jet_v8;
#define WHICH(V)                  which_of_##V
#define COMPARED(V, a, op, b)     _mm512_cmp_pd_mask((__m512d)(a), (__m512d)(b), op)
#define IS_ABOVE(V, a, b)         COMPARED(V, a, _CMP_GT_OQ, b)
#define IS_AT_MOST(V, a, b)       COMPARED(V, a, _CMP_LE_OQ, b)
#define IS_SAME(V, a, b)          COMPARED(V, a, _CMP_EQ_OQ, b)
#define NOT(V, which)             ((WHICH(V)) ~(which))
#define CHOOSE(V, which, yes, no) ((V)_mm512_mask_blend_pd(which, (__m512d)(no), (__m512d)(yes)))
#define WHICH_OF(V, mask)         _mm512_movepi64_mask(_mm512_loadu_si512((mask) + here))
#define SET_WHICH(V, mask, which) _mm512_storeu_si512((mask) + here, _mm512_movm_epi64(which))
JET_INLINE int count_of_jet_v8(__mmask8 which) { return __builtin_popcount(which); }
#else
#define WHICH(V)                  JET_MASK(V)
#define IS_ABOVE(V, a, b)         ((JET_MASK(V))((a) > (b)))
#define IS_AT_MOST(V, a, b)       ((JET_MASK(V))((a) <= (b)))
#define IS_SAME(V, a, b)          ((JET_MASK(V))((a) == (b)))
#define NOT(V, which)             (~(which))
#define CHOOSE(V, which, yes, no) JET_CHOOSE(V, which, yes, no)
#define WHICH_OF(V, mask)         (*(const JET_MASK(V) *)((mask) + here))
#define SET_WHICH(V, mask, which) (*(JET_MASK(V) *)((mask) + here) = (which))
JET_INLINE int count_of_jet_v2(JET_MASK(jet_v2) which) { return -(int)(which[0] + which[1]); }
JET_INLINE int count_of_jet_v4(JET_MASK(jet_v4) which) { return -(int)(which[0] + which[1] + which[2] + which[3]); }
#endif
#define COUNT(V, which)   count_of_##V(which)
#define ARE_ALL(V, which) (COUNT(V, which) == sizeof(V) / sizeof(double))

/* galerkin_batch_loops says what these do. */
int tvi_galerkin_batch_begin(const galerkin_batch_nodes *nodes, const galerkin_batch_history *last, double h,
                             const double t[], const tvi_status status[], const galerkin_batch_passes *passes);
int tvi_galerkin_batch_judge(const galerkin_batch_nodes *nodes, const tvi_passes_rule *rule, int count,
                             const double moved[], const galerkin_batch_passes *passes, bool *any_stuck);

#endif
