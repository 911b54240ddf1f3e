/* lanes.h - Defines vectors over the lanes of a block, whose number is a constant. Files that are compiled once for
 * each instruction set (ad/vector.h) and generated code include it. */
#ifndef TVI_SRC_GALERKIN_LANES_H
#define TVI_SRC_GALERKIN_LANES_H

#include "galerkin/in_library.h"
#include "galerkin/loops.h"
#include "vector.h"

#define KERNEL_JOIN(f, suffix) f##_##suffix
#define KERNEL_NAME(f, suffix) KERNEL_JOIN(f, suffix)

/* ALL_LANES calls BODY(V, blocks) with the widest vector type V that divides the number of lanes, and with the
 * number of such vectors in all lanes. WIDEST is the number of elements of the widest type of the instruction set. */
enum { WIDEST = sizeof(jet_widest) / sizeof(double) };
#define ALL_LANES(lanes, BODY)                                                                                         \
    if (WIDEST >= 8 && lanes % 8 == 0) BODY(jet_v8, (lanes / 8))                                                       \
    else if (WIDEST >= 4 && lanes % 4 == 0) BODY(jet_v4, (lanes / 4))                                                  \
    else if (lanes % 2 == 0) BODY(jet_v2, (lanes / 2))                                                                 \
    else BODY(jet_v1, lanes)

/* A sum is split into this many partial sums, which the processor computes in parallel. */
enum { CHAINS = 4 };

/* These functions return the sum of a vector's elements, by adding its halves. */
JET_INLINE double add_lanes_of_jet_v1(jet_v1 vector) { return vector; }
JET_INLINE double add_lanes_of_jet_v2(jet_v2 vector) { return vector[0] + vector[1]; }
JET_INLINE double add_lanes_of_jet_v4(jet_v4 vector)
{
    return add_lanes_of_jet_v2((jet_v2){vector[0], vector[1]} + (jet_v2){vector[2], vector[3]});
}
JET_INLINE double add_lanes_of_jet_v8(jet_v8 vector)
{
    return add_lanes_of_jet_v4((jet_v4){vector[0], vector[1], vector[2], vector[3]} +
                               (jet_v4){vector[4], vector[5], vector[6], vector[7]});
}

/* These macros access vector k of an array, to write and to read. */
#define BLOCK_AT(V, array, k) (*(V *)((array) + (size_t)(k) * (sizeof(V) / sizeof(double))))
#define BLOCK_OF(V, array, k) (*(const V *)((array) + (size_t)(k) * (sizeof(V) / sizeof(double))))

#endif
