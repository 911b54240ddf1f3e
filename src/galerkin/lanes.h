/* lanes.h - Defines vectors over the lanes of a block. The number of lanes is one of a few, and known to the compiler.
 * Files that are compiled once for each instruction set include it (ad/vector.h). */
#ifndef TVI_SRC_GALERKIN_LANES_H
#define TVI_SRC_GALERKIN_LANES_H

#include "galerkin/in_library.h"
#include "galerkin/loops.h"
#include "vector.h"

#define KERNEL_JOIN(f, suffix) f##_##suffix
#define KERNEL_NAME(f, suffix) KERNEL_JOIN(f, suffix)

/* All lanes at once: BODY(V, blocks), with the jet_widest vectors of which there are as many as make all lanes. */
enum { WIDEST = sizeof(jet_widest) / sizeof(double) };
#define ALL_LANES(lanes, BODY)                                                                                         \
    if (WIDEST >= 8 && lanes % 8 == 0) BODY(jet_v8, (lanes / 8))                                                       \
    else if (WIDEST >= 4 && lanes % 4 == 0) BODY(jet_v4, (lanes / 4))                                                  \
    else if (lanes % 2 == 0) BODY(jet_v2, (lanes / 2))                                                                 \
    else BODY(jet_v1, lanes)

/* The number of sums that do not wait for each other. */
enum { CHAINS = 4 };

/* The sum of a block in halves, which wait less for each other. */
JET_INLINE double sum_of_jet_v1(jet_v1 x) { return x; }
JET_INLINE double sum_of_jet_v2(jet_v2 x) { return x[0] + x[1]; }
JET_INLINE double sum_of_jet_v4(jet_v4 x) { return sum_of_jet_v2((jet_v2){x[0], x[1]} + (jet_v2){x[2], x[3]}); }
JET_INLINE double sum_of_jet_v8(jet_v8 x)
{
    return sum_of_jet_v4((jet_v4){x[0], x[1], x[2], x[3]} + (jet_v4){x[4], x[5], x[6], x[7]});
}

/* Block k of an array. */
#define BLOCK_AT(V, array, k) (*(V *)((array) + (size_t)(k) * (sizeof(V) / sizeof(double))))
#define BLOCK_OF(V, array, k) (*(const V *)((array) + (size_t)(k) * (sizeof(V) / sizeof(double))))

#endif
