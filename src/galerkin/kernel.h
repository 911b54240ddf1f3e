/* kernel.h - Defines the loops of a Galerkin step over its nodes (loops.h explains them). The loops are written once,
 * for a vector type V of successive nodes, and compiled for each length LANES of an array of nodes. VECTORS: the number
 * of vectors in a row. ROW: row u of an array of unknowns. AT: vector v of a row. OF_NODE: vector v of a row of
 * coefficients. OF_TABLE: vector v of row j of a table of coefficients. */
#undef NAME
#define NUMBERS_OF(V) ((int)(sizeof(V) / sizeof(double)))
#define NAME(f)       KERNEL_NAME(f, LANES)
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
#define VECTORS           (LANES / NUMBERS_OF(V))
#define ROW(array, u)     ((array) + (size_t)(u)*LANES)
#define AT(row, v)        (*(V *)((row) + (size_t)(v)*NUMBERS_OF(V)))
#define OF_NODE(table, v) AT(table, v)
#if ONE_VECTOR
#define OF_TABLE(table, j, v) ((table)->row[j])
#else
#define OF_TABLE(table, j, v) OF_NODE((table)->number + (j)*LANES, v)
#endif
#include "galerkin/kernel_nodes.h"
#include "galerkin/kernel_ends.h"
#include "galerkin/kernel_inner.h"
#include "galerkin/kernel_matrices.h"
#include "galerkin/kernel_loops.h"

#undef COLUMN
#undef VECTORS
#undef ROW
#undef AT
#undef OF_NODE
#undef ONE_VECTOR
#undef OF_TABLE
