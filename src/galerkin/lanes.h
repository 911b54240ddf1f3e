/* lanes.h - loops over the lanes of a block whose number is one of a few and known to the compiler; for files that are
 * compiled once for each instruction set (ad/vector.h). */
#ifndef TVI_SRC_GALERKIN_LANES_H
#define TVI_SRC_GALERKIN_LANES_H

#include "galerkin/loops.h"
#include "vector.h"

#define FOR_LANES(lanes, call)                                                                                         \
    switch (lanes) {                                                                                                   \
    case 1: call(1); break;                                                                                            \
    case 2: call(2); break;                                                                                            \
    case 4: call(4); break;                                                                                            \
    case 8: call(8); break;                                                                                            \
    default: call(TVI_GALERKIN_MAX_LANES);                                                                             \
    }

/* name_N(parameters) calls name_lanes(..., N), a function of its own for each number of lanes: what the compiler knows
 * of one spares it the registers of the others. `give` is return, or nothing where nothing is returned.
 * Generated code has one number of lanes. */
#ifdef JET_EMITTED
#define OWN static
#define BY_LANES(result, give, name, parameters, ...)
#else
#define OWN static __attribute__((noinline))
#define BY_LANES(result, give, name, parameters, ...)                                                                  \
    OWN result name##_1 parameters { give name##_lanes(__VA_ARGS__, 1); }                                              \
    OWN result name##_2 parameters { give name##_lanes(__VA_ARGS__, 2); }                                              \
    OWN result name##_4 parameters { give name##_lanes(__VA_ARGS__, 4); }                                              \
    OWN result name##_8 parameters { give name##_lanes(__VA_ARGS__, 8); }                                              \
    OWN result name##_most parameters { give name##_lanes(__VA_ARGS__, TVI_GALERKIN_MAX_LANES); }
#endif

/* The nodes of the curve, which generated code knows. */
#ifdef JET_EMITTED
#define POINTS_OF(weights) ((void)(weights), GALERKIN_POINTS)
#else
#define POINTS_OF(weights) ((weights)->points)
#endif

/* All lanes at once: BODY(V, blocks), with the widest vectors of which there are as many as make all lanes. */
enum { MOST_BLOCKS = TVI_GALERKIN_MAX_LANES };
#ifdef JET_WIDE
enum { WIDEST = 8 };
#elif defined(__AVX__)
enum { WIDEST = 4 };
#else
enum { WIDEST = 2 };
#endif
#define ALL_LANES(lanes, BODY)                                                                                         \
    if (WIDEST >= 8 && lanes % 8 == 0) BODY(jet_v8, (lanes / 8))                                                       \
    else if (WIDEST >= 4 && lanes % 4 == 0) BODY(jet_v4, (lanes / 4))                                                  \
    else if (lanes % 2 == 0) BODY(jet_v2, (lanes / 2))                                                                 \
    else BODY(jet_v1, lanes)

/* A product with a number in memory is one operation, with one of a register's numbers two: what it was is unknown. */
#define LEAVE_REGISTERS(array) __asm__("" : "+r"(array))

/* Sums that do not wait for each other. */
enum { CHAINS = 4 };

/* The sum of a block, in halves, which wait less for each other. */
JET_INLINE double sum_of_jet_v1(jet_v1 x) { return x; }
JET_INLINE double sum_of_jet_v2(jet_v2 x) { return x[0] + x[1]; }
JET_INLINE double sum_of_jet_v4(jet_v4 x) { return sum_of_jet_v2((jet_v2){x[0], x[1]} + (jet_v2){x[2], x[3]}); }
JET_INLINE double sum_of_jet_v8(jet_v8 x)
{
    return sum_of_jet_v4((jet_v4){x[0], x[1], x[2], x[3]} + (jet_v4){x[4], x[5], x[6], x[7]});
}

/* Block k of them. */
#define BLOCK_AT(V, array, k) (*(V *)((array) + (size_t)(k) * (sizeof(V) / sizeof(double))))
#define BLOCK_OF(V, array, k) (*(const V *)((array) + (size_t)(k) * (sizeof(V) / sizeof(double))))

/* So many rows. */
#define COPY(V, blocks)                                                                                                \
    for (int k = 0; k < (blocks); k++) BLOCK_AT(V, to, k) = BLOCK_OF(V, from, k);
JET_INLINE void copy_lanes(double *to, const double *from, int count, int lanes)
{
    for (int u = 0; u < count; u++, to += lanes, from += lanes) ALL_LANES(lanes, COPY)
}

#endif
