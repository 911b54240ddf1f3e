/* sum_products.c - Computes sums of products, z = sum_t c_t a_t b_t and z = sum_t c_t a_t^2, for the values, series,
 * tangents and adjoints of a tape (sums.h). Term t has the coefficient c_t and the factors a_t and b_t, whose
 * coefficients of order j are a_j and b_j in the formulas of a term. The convolutions of squares are symmetric, and
 * need half the products. All terms are added while the vector of z is in a register. */
#include "sums.h"

/* Defines the table of functions name[are_squares][term_count](parameters), with one function for each number of terms
 * of PRODUCTS and of SQUARES. */
#define TABLE(name, body, parameters, ...)                                                                             \
    JET_BY_TERMS(name##_products, body, parameters, __VA_ARGS__, false)                                                \
    JET_BY_TERMS(name##_squares, body, parameters, __VA_ARGS__, true)                                                  \
    static void(*const name[2][1 + JET_TERMS_MAX]) parameters = {                                                      \
        {NULL, name##_products_1, name##_products_2, name##_products_3, name##_products_4},                            \
        {NULL, name##_squares_1, name##_squares_2, name##_squares_3, name##_squares_4},                                \
    };
#define FUNCTION(name, run) name[(run)->op == OP_SQUARES][(run)->term_count]

/* The terms c_t a_t b_t of the sum of products that the first operation of a run computes: coefficients, and pointers
 * to the factors in a block. The factors of the following operations are adjacent to them. */
typedef struct {
    double coefficient[JET_TERMS_MAX];
    const double *factor_a[JET_TERMS_MAX], *factor_b[JET_TERMS_MAX];
} sum_of_products_terms;

JET_INLINE sum_of_products_terms locate_run_terms(const jet_tape *tape, const jet_run_of_operations *run,
                                                  const double *block, size_t lanes, int term_count)
{
    sum_of_products_terms p;
    for (int t = 0; t < term_count; t++) {
        const int term = run->first_term_index + t;
        p.coefficient[t] = tape->terms.coefficient[term];
        p.factor_a[t] = block + (size_t)tape->terms.slot[term] * lanes;
        p.factor_b[t] = block + (size_t)tape->terms.slot_b[term] * lanes;
    }
    return p;
}

/* Adds sum_{j=from}^{to} term(t, j) to sum_t, for all t in one loop over j. The bodies order the summands so that the
 * factors that a recurrence computes last come at the last j, and the other summands need not wait for them. */
#define SUMS(V, sum, from, to, term)                                                                                   \
    if (term_count == 1) {                                                                                             \
        const int t = 0;                                                                                               \
        JET_SUM(V, sum[0], from, to, term);                                                                            \
    } else                                                                                                             \
        for (int j = (from), most = (to); j <= most; j++)                                                              \
            for (int t = 0; t < term_count; t++) sum[t] += term;

/* ---- Values ------------------------------------------------------------------------------------------------------ */

#define VALUES(V, S)                                                                                                   \
    {                                                                                                                  \
        V sum = p.coefficient[0] * S(V, p.factor_a[0], 0) * S(V, p.factor_b[0], 0);                                    \
        for (int t = 1; t < term_count; t++)                                                                           \
            sum += p.coefficient[t] * S(V, p.factor_a[t], 0) * S(V, p.factor_b[t], 0);                                 \
        JET_AT(V, z, 0) = sum;                                                                                         \
    }

/* Computes the operations of a run in a sweep of values. Each operation is a sum of term_count products. */
JET_INLINE void compute_product_values(const jet_tape *tape, const jet_run_of_operations *run, double *block, int lanes,
                                       bool are_squares, int term_count)
{
    const sum_of_products_terms p = locate_run_terms(tape, run, block, (size_t)lanes, term_count);
    const size_t stride = (size_t)lanes;
    const int width = run->operation_count * lanes;
    double *z = block + (size_t)run->z * stride;
    (void)are_squares; /* b is a */
    if (lanes == 8) JET_BLOCKS_OF_8(width, VALUES, JET_OF)
    else JET_BLOCKS(width, VALUES, JET_OF);
}
TABLE(values_eight, compute_product_values, (const jet_tape *tape, const jet_run_of_operations *run, double *block),
      tape, run, block, 8)
TABLE(values_any, compute_product_values,
      (const jet_tape *tape, const jet_run_of_operations *run, double *block, int lanes), tape, run, block, lanes)

void jet_compute_product_values(const jet_tape *tape, const jet_run_of_operations *run, double *block, int lanes)
{
    if (lanes == 8) FUNCTION(values_eight, run)(tape, run, block);
    else FUNCTION(values_any, run)(tape, run, block, lanes);
}

/* ---- Series ------------------------------------------------------------------------------------------------------ */

/* The series rule of PRODUCTS computes z_k:
 * z_k = sum_t c_t sum_{j=0}^{k} a_j b_{k-j}.   O(N^2). */
#define PRODUCTS_SERIES(V, S)                                                                                          \
    {                                                                                                                  \
        V sum[JET_TERMS_MAX] = {0};                                                                                    \
        SUMS(V, sum, 0, k, S(V, p.factor_a[t], k - j) * S(V, p.factor_b[t], j))                                        \
        V total = p.coefficient[0] * sum[0];                                                                           \
        for (int t = 1; t < term_count; t++) total += p.coefficient[t] * sum[t];                                       \
        JET_AT(V, z, k) = total;                                                                                       \
    }

/* The series rule of SQUARES computes z_k:
 * z_k = sum_t c_t (2 sum_{j < k/2} a_j a_{k-j} + (a_{k/2}^2 for even k)). */
#define SQUARE(V, S, t)                                                                                                \
    (p.coefficient[t] *                                                                                                \
     (2.0 * sum[t] + (k % 2 == 0 ? 1.0 : 0.0) * (S(V, p.factor_a[t], k / 2) * S(V, p.factor_a[t], k / 2))))
#define SQUARES_SERIES(V, S)                                                                                           \
    {                                                                                                                  \
        const int half = (k - 1) / 2;                                                                                  \
        V sum[JET_TERMS_MAX] = {0};                                                                                    \
        SUMS(V, sum, 0, half, S(V, p.factor_a[t], half - j) * S(V, p.factor_a[t], k - half + j))                       \
        V total = SQUARE(V, S, 0);                                                                                     \
        for (int t = 1; t < term_count; t++) total += SQUARE(V, S, t);                                                 \
        JET_AT(V, z, k) = total;                                                                                       \
    }

JET_INLINE void compute_product_series_order(const jet_tape *tape, const jet_run_of_operations *run, double *block,
                                             int k, size_t lanes, bool are_squares, int term_count)
{
    const sum_of_products_terms p = locate_run_terms(tape, run, block, lanes, term_count);
    const size_t stride = (size_t)tape->slot_count * lanes;
    const int width = run->operation_count * (int)lanes;
    double *z = block + (size_t)run->z * lanes;
    if (are_squares) JET_BLOCKS(width, SQUARES_SERIES, JET_OF);
    else JET_BLOCKS(width, PRODUCTS_SERIES, JET_OF);
}

TABLE(series_one, compute_product_series_order,
      (const jet_tape *tape, const jet_run_of_operations *run, double *block, int k), tape, run, block, k, 1)
TABLE(series_any, compute_product_series_order,
      (const jet_tape *tape, const jet_run_of_operations *run, double *block, int k, int lanes), tape, run, block, k,
      (size_t)lanes)

void jet_compute_product_series_order(const jet_tape *tape, const jet_run_of_operations *run, double *block, int k,
                                      int lanes)
{
    if (lanes == 1) FUNCTION(series_one, run)(tape, run, block, k);
    else FUNCTION(series_any, run)(tape, run, block, k, lanes);
}

/* ---- Tangents ---------------------------------------------------------------------------------------------------- */

/* The tangent rule computes dz_k:
 * dz_k = sum_t c_t sum_{j=0}^{k} (b_j da_{k-j} + a_j db_{k-j}). */
#define PRODUCTS_TANGENT(V, S)                                                                                         \
    {                                                                                                                  \
        V sum[JET_TERMS_MAX] = {0}, total = {0};                                                                       \
        SUMS(V, sum, 0, k,                                                                                             \
             S(V, p.factor_b[t] + i, k - j) * JET_D_OF(V, d.factor_a[t] + i * lanes, j) +                              \
                 S(V, p.factor_a[t] + i, k - j) * JET_D_OF(V, d.factor_b[t] + i * lanes, j))                           \
        for (int t = 0; t < term_count; t++) total += p.coefficient[t] * sum[t];                                       \
        JET_D_AT(V, dz, k) = total;                                                                                    \
    }

/* The tangent rule computes dz_k:
 * dz_k = 2 sum_t c_t sum_{j=0}^{k} a_j da_{k-j}. */
#define SQUARES_TANGENT(V, S)                                                                                          \
    {                                                                                                                  \
        V sum[JET_TERMS_MAX] = {0}, total = {0};                                                                       \
        SUMS(V, sum, 0, k, S(V, p.factor_a[t] + i, k - j) * JET_D_OF(V, d.factor_a[t] + i * lanes, j))                 \
        for (int t = 0; t < term_count; t++) total += 2 * p.coefficient[t] * sum[t];                                   \
        JET_D_AT(V, dz, k) = total;                                                                                    \
    }

/* Calls the body TANGENT for a run. If the block of the series has as many lanes as that of the tangents, it processes
 * the operations of the run and their lanes as one array. Otherwise it processes the lanes of each operation i. */
#define TANGENT_OF(TANGENT)                                                                                            \
    if (lanes == block_lanes) {                                                                                        \
        const size_t i = 0;                                                                                            \
        const int width = run->operation_count * (int)lanes;                                                           \
        JET_BLOCKS(width, TANGENT, JET_OF);                                                                            \
    } else {                                                                                                           \
        for (size_t i = 0; i < (size_t)run->operation_count; i++, dz += lanes)                                         \
            JET_BLOCKS((int)lanes, TANGENT, JET_ONE_OF);                                                               \
    }

JET_INLINE void compute_product_tangents(const jet_tape *tape, const jet_run_of_operations *run, const double *block,
                                         double *tangent_block, int k, size_t block_lanes, size_t lanes,
                                         bool are_squares, int term_count)
{
    const sum_of_products_terms p = locate_run_terms(tape, run, block, block_lanes, term_count),
                                d = locate_run_terms(tape, run, tangent_block, lanes, term_count);
    const size_t stride = (size_t)tape->slot_count * block_lanes, dstride = (size_t)tape->slot_count * lanes;
    double *dz = tangent_block + (size_t)run->z * lanes;
    if (are_squares) {
        TANGENT_OF(SQUARES_TANGENT)
    } else {
        TANGENT_OF(PRODUCTS_TANGENT)
    }
}

TABLE(tangents_one, compute_product_tangents,
      (const jet_tape *tape, const jet_run_of_operations *run, const double *block, double *tangent_block, int k,
       int lanes),
      tape, run, block, tangent_block, k, 1, (size_t)lanes)
TABLE(tangents_own, compute_product_tangents,
      (const jet_tape *tape, const jet_run_of_operations *run, const double *block, double *tangent_block, int k,
       int lanes),
      tape, run, block, tangent_block, k, (size_t)lanes, (size_t)lanes)

void jet_compute_product_tangents(const jet_tape *tape, const jet_run_of_operations *run, const double *block,
                                  double *tangent_block, int k, int block_lanes, int lanes)
{
    if (block_lanes == 1) FUNCTION(tangents_one, run)(tape, run, block, tangent_block, k, lanes);
    else FUNCTION(tangents_own, run)(tape, run, block, tangent_block, k, lanes);
}

/* ---- Adjoints ---------------------------------------------------------------------------------------------------- */

/* Most rules add contributions of one order of z to many orders of their operands. This rule sums the contributions of
 * many orders of z to order k of the operands, in registers:
 * abar_k += c_t sum_{j=k}^{top} zbar_j b_{j-k},  and likewise bbar_k += c_t sum_{j=k}^{top} zbar_j a_{j-k}. */
#define PRODUCTS_ADJOINT(V, S)                                                                                         \
    for (int t = 0; t < term_count; t++) {                                                                             \
        V of_a = {0}, of_b = {0};                                                                                      \
        for (int j = top; j >= k; j--) {                                                                               \
            of_a += S(V, zbar, j) * S(V, p.factor_b[t], j - k);                                                        \
            of_b += S(V, zbar, j) * S(V, p.factor_a[t], j - k);                                                        \
        }                                                                                                              \
        JET_AT(V, abar[t], k) += p.coefficient[t] * of_a;                                                              \
        JET_AT(V, bbar[t], k) += p.coefficient[t] * of_b;                                                              \
    }

/* The adjoint rule updates the adjoints:
 * abar_k += 2 c_t sum_{j=k}^{top} zbar_j a_{j-k}. */
#define SQUARES_ADJOINT(V, S)                                                                                          \
    {                                                                                                                  \
        V sum[JET_TERMS_MAX] = {0};                                                                                    \
        SUMS(V, sum, k, top, S(V, zbar, k + top - j) * S(V, p.factor_a[t], top - j))                                   \
        for (int t = 0; t < term_count; t++) JET_AT(V, abar[t], k) += 2 * p.coefficient[t] * sum[t];                   \
    }

JET_INLINE void add_product_adjoints(const jet_tape *tape, const jet_run_of_operations *run, const double *block,
                                     double *adjoint_block, int k, int top, bool are_squares, int term_count)
{
    const sum_of_products_terms p = locate_run_terms(tape, run, block, 1, term_count);
    const size_t stride = (size_t)tape->slot_count;
    const double *zbar = adjoint_block + run->z;
    double *abar[JET_TERMS_MAX], *bbar[JET_TERMS_MAX];
    for (int t = 0; t < term_count; t++) {
        abar[t] = adjoint_block + tape->terms.slot[run->first_term_index + t];
        bbar[t] = adjoint_block + tape->terms.slot_b[run->first_term_index + t];
    }
    if (are_squares) JET_BLOCKS(run->operation_count, SQUARES_ADJOINT, JET_OF);
    else JET_BLOCKS(run->operation_count, PRODUCTS_ADJOINT, JET_OF);
}

TABLE(adjoints, add_product_adjoints,
      (const jet_tape *tape, const jet_run_of_operations *run, const double *block, double *adjoint_block, int k,
       int top),
      tape, run, block, adjoint_block, k, top)

void jet_add_product_adjoints(const jet_tape *tape, const jet_run_of_operations *run, const double *block,
                              double *adjoint_block, int k, int top)
{
    FUNCTION(adjoints, run)(tape, run, block, adjoint_block, k, top);
}
