/* sum_products.c - Computes z = sum_t c_t a_t b_t, and z = sum_t c_t a_t^2, whose convolutions are symmetric and need
 * half the products. All terms are added while a block of z is in a register. */
#include "devices.h"
#include "sums.h"

/* Defines name[squares][terms](parameters): a function for each number of terms of each operation. */
#define TABLE(name, body, parameters, ...)                                                                             \
    JET_BY_TERMS(name##_products, body, parameters, __VA_ARGS__, false)                                                \
    JET_BY_TERMS(name##_squares, body, parameters, __VA_ARGS__, true)                                                  \
    static void(*const name[2][1 + JET_TERMS_MAX]) parameters = {                                                      \
        {NULL, name##_products_1, name##_products_2, name##_products_3, name##_products_4},                            \
        {NULL, name##_squares_1, name##_squares_2, name##_squares_3, name##_squares_4},                                \
    };
#define FUNCTION(name, run) name[(run)->op == OP_SQUARES][(run)->terms]

/* The terms of the run's first member, in the block x; those of the next ones stand beside them. */
typedef struct {
    double c[JET_TERMS_MAX];
    const double *a[JET_TERMS_MAX], *b[JET_TERMS_MAX];
} products;

JET_INLINE products terms_at(const double *c, const int *a, const int *b, const double *x, size_t lanes, int terms)
{
    products p;
    for (int t = 0; t < terms; t++) {
        p.c[t] = c[t];
        p.a[t] = x + (size_t)a[t] * lanes;
        p.b[t] = x + (size_t)b[t] * lanes;
    }
    return p;
}

JET_INLINE products terms_of(const jet_tape *tape, const jet_run *run, const double *x, size_t lanes, int terms)
{
    const int first = run->term;
    return terms_at(tape->term_coefficient + first, tape->term_slot + first, tape->term_operand_b + first, x, lanes,
                    terms);
}

/* sum_t += sum_{j=from}^{to} term(t, j) for all t at once. The last term contains the numbers that are known last. */
#define SUMS(V, sum, from, to, term)                                                                                   \
    if (terms == 1) {                                                                                                  \
        const int t = 0;                                                                                               \
        JET_SUM(V, sum[0], from, to, term);                                                                            \
    } else                                                                                                             \
        for (int j = (from), most = (to); j <= most; j++)                                                              \
            for (int t = 0; t < terms; t++) sum[t] += term;

/* ---- Values ------------------------------------------------------------------------------------------------------ */

#define VALUES(V, S)                                                                                                   \
    {                                                                                                                  \
        V sum = p.c[0] * S(V, p.a[0], 0) * S(V, p.b[0], 0);                                                            \
        for (int t = 1; t < terms; t++) sum += p.c[t] * S(V, p.a[t], 0) * S(V, p.b[t], 0);                             \
        JET_AT(V, z, 0) = sum;                                                                                         \
    }

JET_INLINE void values_of(const jet_tape *tape, const jet_run *run, double *x, int lanes, bool squares, int terms)
{
    const products p = terms_of(tape, run, x, (size_t)lanes, terms);
    const size_t stride = (size_t)lanes;
    const int width = run->count * lanes;
    double *z = x + (size_t)run->z * stride;
    (void)squares; /* b is a */
    if (lanes == 8) JET_BLOCKS_OF_8(width, VALUES, JET_OF)
    else JET_BLOCKS(width, VALUES, JET_OF);
}
TABLE(values_eight, values_of, (const jet_tape *tape, const jet_run *run, double *x), tape, run, x, 8)
TABLE(values_any, values_of, (const jet_tape *tape, const jet_run *run, double *x, int lanes), tape, run, x, lanes)

JET_INLINE void scattered_values_of(const jet_tape *tape, const jet_run *run, double *x, int lanes, bool squares,
                                    int terms)
{
    const size_t stride = (size_t)lanes;
    const double *c = tape->term_coefficient + run->term;
    const int *a = tape->term_slot + run->term, *b = squares ? a : tape->term_operand_b + run->term;
    double *z = x + (size_t)run->z * stride, *const end = z + (size_t)run->count * stride;
    for (; z < end; z += stride, a += terms, b += terms, c += terms) {
        const products p = terms_at(c, a, b, x, stride, terms);
        JET_BLOCKS(lanes, VALUES, JET_OF);
    }
}
TABLE(scattered_eight, scattered_values_of, (const jet_tape *tape, const jet_run *run, double *x), tape, run, x, 8)
TABLE(scattered_any, scattered_values_of, (const jet_tape *tape, const jet_run *run, double *x, int lanes), tape, run,
      x, lanes)

void jet_product_values(const jet_tape *tape, const jet_run *run, double *x, int lanes)
{
    if (run->is_scattered && lanes == 8) FUNCTION(scattered_eight, run)(tape, run, x);
    else if (run->is_scattered) FUNCTION(scattered_any, run)(tape, run, x, lanes);
    else if (lanes == 8) FUNCTION(values_eight, run)(tape, run, x);
    else FUNCTION(values_any, run)(tape, run, x, lanes);
}

/* ---- Series ------------------------------------------------------------------------------------------------------ */

/* z_k = sum_t c_t sum_{j=0}^{k} a_j b_{k-j}.   O(N^2). */
#define PRODUCTS_ORDER(V, A, B)                                                                                        \
    V sum[JET_TERMS_MAX] = {0};                                                                                        \
    SUMS(V, sum, 0, k, A(V, p.a[t], k - j) * B(V, p.b[t], j))                                                          \
    V total = p.c[0] * sum[0];                                                                                         \
    for (int t = 1; t < terms; t++) total += p.c[t] * sum[t];
#define PRODUCTS_SERIES(V, S)                                                                                          \
    {                                                                                                                  \
        PRODUCTS_ORDER(V, S, S)                                                                                        \
        JET_AT(V, z, k) = total;                                                                                       \
    }

/* z_k = sum_t c_t (2 sum_{j < k/2} a_j a_{k-j} + (a_{k/2}^2 for even k)). */
#define SQUARE(V, S, t)                                                                                                \
    (p.c[t] * (2.0 * sum[t] + (k % 2 == 0 ? 1.0 : 0.0) * (S(V, p.a[t], k / 2) * S(V, p.a[t], k / 2))))
#define SQUARES_ORDER(V, S)                                                                                            \
    const int half = (k - 1) / 2;                                                                                      \
    V sum[JET_TERMS_MAX] = {0};                                                                                        \
    SUMS(V, sum, 0, half, S(V, p.a[t], half - j) * S(V, p.a[t], k - half + j))                                         \
    V total = SQUARE(V, S, 0);                                                                                         \
    for (int t = 1; t < terms; t++) total += SQUARE(V, S, t);
#define SQUARES_SERIES(V, S)                                                                                           \
    {                                                                                                                  \
        SQUARES_ORDER(V, S)                                                                                            \
        JET_AT(V, z, k) = total;                                                                                       \
    }

#ifdef JET_EMITTED
/* Tells whether a sum of two squares is of adjacent numbers with the same coefficient, which are one vector. */
JET_INLINE bool are_neighbours(const products *p, int count, int terms)
{
    return JET_HAS(PAIRS) && terms == 2 && count == 1 && p->a[1] == p->a[0] + 1 && p->c[0] == p->c[1];
}

JET_INLINE void squares_of_neighbours(products p, double *z, size_t stride, int k)
{
    const size_t here = 0;
    const int terms = 1;
    SQUARES_ORDER(jet_v2, JET_OF)
    JET_AT(jet_v1, z, k) = total[0] + total[1];
}
#endif

JET_INLINE void series_of(const jet_tape *tape, const jet_run *run, double *x, int k, size_t lanes, bool squares,
                          int terms)
{
    const products p = terms_of(tape, run, x, lanes, terms);
    const size_t stride = (size_t)tape->slots * lanes;
    const int width = run->count * (int)lanes;
    double *z = x + (size_t)run->z * lanes;
#ifdef JET_EMITTED
    if (squares && are_neighbours(&p, width, terms)) {
        squares_of_neighbours(p, z, stride, k);
        return;
    }
#endif
    if (squares) JET_BLOCKS(width, SQUARES_SERIES, JET_OF);
    else JET_BLOCKS(width, PRODUCTS_SERIES, JET_OF);
}

#ifdef JET_EMITTED
/* Computes the series of two runs with a common factor b, whose other factors are adjacent (emit.c), in one vector. */
JET_INLINE void paired_series_of(const jet_tape *tape, const jet_run *run, const jet_run *partner, double *x, int k)
{
    const bool is_first = tape->term_slot[run->term] < tape->term_slot[partner->term];
    const products p = terms_of(tape, is_first ? run : partner, x, 1, 1);
    const size_t stride = (size_t)tape->slots, here = 0;
    const int terms = 1;
    double *z = x + (size_t)k * stride;
    PRODUCTS_ORDER(jet_v2, JET_OF, JET_ONE_OF)
    const int low = is_first ? run->z : partner->z, high = is_first ? partner->z : run->z;
    if (high == low + 1) *(jet_v2 *)(z + low) = total;
    else if (low == high + 1) *(jet_v2 *)(z + high) = JET_SWAPPED(total);
    else z[low] = total[0], z[high] = total[1];
}
#endif

TABLE(series_one, series_of, (const jet_tape *tape, const jet_run *run, double *x, int k), tape, run, x, k, 1)
TABLE(series_any, series_of, (const jet_tape *tape, const jet_run *run, double *x, int k, int lanes), tape, run, x, k,
      (size_t)lanes)

void jet_product_series(const jet_tape *tape, const jet_run *run, double *x, int k, int lanes)
{
    if (lanes == 1) FUNCTION(series_one, run)(tape, run, x, k);
    else FUNCTION(series_any, run)(tape, run, x, k, lanes);
}

/* ---- Tangents ---------------------------------------------------------------------------------------------------- */

/* dz_k = sum_t c_t sum_{j=0}^{k} (b_j da_{k-j} + a_j db_{k-j}). */
#define PRODUCTS_TANGENT(V, S)                                                                                         \
    {                                                                                                                  \
        V sum[JET_TERMS_MAX] = {0}, total = {0};                                                                       \
        SUMS(V, sum, 0, k,                                                                                             \
             S(V, p.b[t] + i, k - j) * JET_D_OF(V, d.a[t] + i * lanes, j) +                                            \
                 S(V, p.a[t] + i, k - j) * JET_D_OF(V, d.b[t] + i * lanes, j))                                         \
        for (int t = 0; t < terms; t++) total += p.c[t] * sum[t];                                                      \
        JET_D_AT(V, dz, k) = total;                                                                                    \
    }

/* dz_k = 2 sum_t c_t sum_{j=0}^{k} a_j da_{k-j}. */
#define SQUARES_TANGENT(V, S)                                                                                          \
    {                                                                                                                  \
        V sum[JET_TERMS_MAX] = {0}, total = {0};                                                                       \
        SUMS(V, sum, 0, k, S(V, p.a[t] + i, k - j) * JET_D_OF(V, d.a[t] + i * lanes, j))                               \
        for (int t = 0; t < terms; t++) total += 2 * p.c[t] * sum[t];                                                  \
        JET_D_AT(V, dz, k) = total;                                                                                    \
    }

/* Goes across the members if x has as many lanes as dx, otherwise across the lanes of each member i. */
#define TANGENT_OF(TANGENT)                                                                                            \
    if (lanes == lanes_of_x) {                                                                                         \
        const size_t i = 0;                                                                                            \
        const int width = run->count * (int)lanes;                                                                     \
        JET_BLOCKS(width, TANGENT, JET_OF);                                                                            \
    } else {                                                                                                           \
        for (size_t i = 0; i < (size_t)run->count; i++, dz += lanes) JET_BLOCKS((int)lanes, TANGENT, JET_ONE_OF);      \
    }

JET_INLINE void tangents_of(const jet_tape *tape, const jet_run *run, const double *x, double *dx, int k,
                            size_t lanes_of_x, size_t lanes, bool squares, int terms)
{
    const products p = terms_of(tape, run, x, lanes_of_x, terms), d = terms_of(tape, run, dx, lanes, terms);
    const size_t stride = (size_t)tape->slots * lanes_of_x, dstride = (size_t)tape->slots * lanes;
    double *dz = dx + (size_t)run->z * lanes;
    if (squares) {
        TANGENT_OF(SQUARES_TANGENT)
    } else {
        TANGENT_OF(PRODUCTS_TANGENT)
    }
}

TABLE(tangents_one, tangents_of,
      (const jet_tape *tape, const jet_run *run, const double *x, double *dx, int k, int lanes), tape, run, x, dx, k, 1,
      (size_t)lanes)
TABLE(tangents_own, tangents_of,
      (const jet_tape *tape, const jet_run *run, const double *x, double *dx, int k, int lanes), tape, run, x, dx, k,
      (size_t)lanes, (size_t)lanes)

void jet_product_tangent(const jet_tape *tape, const jet_run *run, const double *x, double *dx, int k, int lanes_of_x,
                         int lanes)
{
    if (lanes_of_x == 1) FUNCTION(tangents_one, run)(tape, run, x, dx, k, lanes);
    else FUNCTION(tangents_own, run)(tape, run, x, dx, k, lanes);
}

/* ---- Adjoints ---------------------------------------------------------------------------------------------------- */

/* Most rules add contributions of one order of z to many orders of their operands. This one sums the contributions of
 * many orders of z to one order of the operands, in registers:
 * abar_k += c_t sum_{j=k}^{top} zbar_j b_{j-k},  bbar_k likewise. */
#define PRODUCTS_ADJOINT(V, S)                                                                                         \
    for (int t = 0; t < terms; t++) {                                                                                  \
        V of_a = {0}, of_b = {0};                                                                                      \
        for (int j = top; j >= k; j--) {                                                                               \
            of_a += S(V, zbar, j) * S(V, p.b[t], j - k);                                                               \
            of_b += S(V, zbar, j) * S(V, p.a[t], j - k);                                                               \
        }                                                                                                              \
        JET_ADD_TO(V, abar[t], 2 * t, p.c[t] * of_a);                                                                  \
        JET_ADD_TO(V, bbar[t], 2 * t + 1, p.c[t] * of_b);                                                              \
    }

/* abar_k += 2 c_t sum_{j=k}^{top} zbar_j a_{j-k}. */
#define SQUARES_ADJOINT(V, S)                                                                                          \
    {                                                                                                                  \
        V sum[JET_TERMS_MAX] = {0};                                                                                    \
        SUMS(V, sum, k, top, S(V, zbar, k + top - j) * S(V, p.a[t], top - j))                                          \
        for (int t = 0; t < terms; t++) JET_ADD_TO(V, abar[t], 2 * t, 2 * p.c[t] * sum[t]);                            \
    }

JET_INLINE void adjoints_of(const jet_tape *tape, const jet_run *run, const double *x, double *bars, int k, int top,
                            bool squares, int terms)
{
    const products p = terms_of(tape, run, x, 1, terms);
    const size_t stride = (size_t)tape->slots;
    const double *zbar = bars + run->z;
    double *abar[JET_TERMS_MAX], *bbar[JET_TERMS_MAX];
    for (int t = 0; t < terms; t++) {
        abar[t] = bars + tape->term_slot[run->term + t];
        bbar[t] = bars + tape->term_operand_b[run->term + t];
    }
    if (squares) JET_BLOCKS(run->count, SQUARES_ADJOINT, JET_OF);
    else JET_BLOCKS(run->count, PRODUCTS_ADJOINT, JET_OF);
}

TABLE(adjoints, adjoints_of, (const jet_tape *tape, const jet_run *run, const double *x, double *bars, int k, int top),
      tape, run, x, bars, k, top)

void jet_product_adjoint(const jet_tape *tape, const jet_run *run, const double *x, double *bars, int k, int top)
{
    FUNCTION(adjoints, run)(tape, run, x, bars, k, top);
}
