/* kernel.h - Defines the loops of a Galerkin step over its nodes (loops.h explains them). The loops are written once,
 * for a vector type V, and compiled several times: for each length LANES of an array of nodes of a single orbit, where
 * V holds successive nodes, and for MEMBERS, several orbits of an ensemble, where V holds one node of successive
 * members and `here` is the number of the first of them. The code is the same for both, so that a member gets the same
 * results alone and in a batch, bit for bit. */
#undef NAME
#define NUMBERS_OF(V) ((int)(sizeof(V) / sizeof(double)))
#if MEMBERS
#define NAME(f)    KERNEL_NAME(f, members)
#define V          jet_widest
#define ONE_VECTOR 0
#define COLUMN     jet_widest
/* VECTORS: the number of vectors in a row. ROW: row u of an array of unknowns. AT: vector v of a row. OF_NODE: vector v
 * of a row of coefficients, [lanes]. OF_TABLE: vector v of row j of a table of coefficients. NUMBER: the value of each
 * member at node j. MEMBER: the type of one number for each member. MEMBER_AT: element u of an array of such numbers.
 * IF_ABOVE: `yes` if a > b, otherwise `no`. KEPT: `now` for members that still move, otherwise `was`. */
#define VECTORS                 (shape.node_count)
#define ROW(array, u)           ((array) + (size_t)(u) * (size_t)(shape.node_count * shape.member_count) + here)
#define AT(row, v)              (*(V *)((row) + (size_t)(v) * (size_t)shape.member_count))
#define OF_NODE(table, v)       ((table)[v] - (V){0})
#define OF_TABLE(table, j, v)   OF_NODE((table)->number + (j)*shape.lane_count, v)
#define NUMBER(row, j)          AT(row, j)
#define MEMBER                  V
#define MEMBER_AT(array, u)     (*(V *)((array) + (size_t)(u) * (size_t)shape.member_count + here))
#define MAGNITUDE(x)            JET_ABS(V, x)
#define IF_ABOVE(a, b, yes, no) JET_CHOOSE(V, (a) > (b), yes, no)
#define KEPT(now, was)          JET_CHOOSE(V, *(const JET_MASK(jet_widest) *)(nodes->moving_mask + here), now, was)
/* Makes the call `call` for each vector of members. Inside the call the numbers P of nodes, L of lanes and W of members
 * are the sizes `shape`, which EACH_VECTOR makes compile-time constants for the usual numbers. */
#define EACH_VECTOR_OF(P, L, W, call)                                                                                  \
    do {                                                                                                               \
        const galerkin_array_shape shape = {P, L, W};                                                                  \
        for (size_t here = 0; here < (size_t)shape.member_count; here += NUMBERS_OF(V)) call;                          \
    } while (0)
#define EACH_VECTOR(call)                                                                                              \
    do {                                                                                                               \
        if (nodes->node_count == 8 && nodes->member_count == 8) EACH_VECTOR_OF(8, 8, 8, call);                         \
        else if (nodes->node_count == 8 && nodes->member_count == 16) EACH_VECTOR_OF(8, 8, 16, call);                  \
        else if (nodes->node_count == 8 && nodes->member_count == 32) EACH_VECTOR_OF(8, 8, 32, call);                  \
        else EACH_VECTOR_OF(nodes->node_count, nodes->lane_count, nodes->member_count, call);                          \
    } while (0)
#else
#define NAME(f) KERNEL_NAME(f, LANES)
#if LANES % 8 == 0 && defined(JET_WIDE)
#define V          jet_v8
#define ONE_VECTOR (LANES == 8)
#elif LANES % 4 == 0 && defined(__AVX__)
#define V          jet_v4
#define ONE_VECTOR (LANES == 4)
#elif LANES % 2 == 0
#define V          jet_v2
#define ONE_VECTOR (LANES == 2)
#else
#define V          jet_v1
#define ONE_VECTOR 1
#endif
#ifdef __AVX__
#define COLUMN jet_v4
#else
#define COLUMN jet_v2
#endif
#define VECTORS           (shape.lane_count / NUMBERS_OF(V))
#define ROW(array, u)     ((array) + (size_t)(u) * (size_t)shape.lane_count + here)
#define AT(row, v)        (*(V *)((row) + (size_t)(v)*NUMBERS_OF(V)))
#define OF_NODE(table, v) AT(table, v)
#if ONE_VECTOR
#define OF_TABLE(table, j, v) ((table)->row[j])
#else
#define OF_TABLE(table, j, v) OF_NODE((table)->number + (j)*LANES, v)
#endif
#define NUMBER(row, j)          ((row)[j])
#define MEMBER                  double
#define MEMBER_AT(array, u)     ((array)[(size_t)(u) + here])
#define MAGNITUDE(x)            fabs(x)
#define IF_ABOVE(a, b, yes, no) ((a) > (b) ? (yes) : (no))
#define KEPT(now, was)          (now)
#define SHAPE_OF(nodes)         ((galerkin_array_shape){NODE_COUNT_OF(nodes), LANES, 1})
#define EACH_VECTOR(call)                                                                                              \
    do {                                                                                                               \
        const galerkin_array_shape shape = SHAPE_OF(nodes);                                                            \
        const size_t here = 0;                                                                                         \
        call;                                                                                                          \
    } while (0)
#endif

#include "galerkin/kernel_nodes.h"
#include "galerkin/kernel_ends.h"
#if !MEMBERS
#include "galerkin/kernel_inner.h"
#include "galerkin/kernel_matrices.h"
#endif
#include "galerkin/kernel_loops.h"

#undef COLUMN
#undef VECTORS
#undef ROW
#undef AT
#undef OF_NODE
#undef ONE_VECTOR
#undef OF_TABLE
#undef NUMBER
#undef MEMBER
#undef MEMBER_AT
#undef MAGNITUDE
#undef IF_ABOVE
#undef KEPT
#undef SHAPE_OF
#undef EACH_VECTOR_OF
#undef EACH_VECTOR
#undef NUMBERS_IN
