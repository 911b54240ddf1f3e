/* advance.h - one order of a curve's recurrence (curve.c): part of the text of generated code, where every size is a
 * constant. */
#ifndef TVI_SRC_GENERATING_ADVANCE_H
#define TVI_SRC_GENERATING_ADVANCE_H

#include "vector.h"
#ifdef __FMA__
#include <immintrin.h>
#endif

typedef struct {
    int n;
    size_t stride;     /* of orders in the block */
    const int *output; /* slots of the field */
    double *x;         /* block of the series */
    const double *kappa;
    double tau;
} tvi_recurrence;

/* x / divisor, which orders wait for: by the reciprocal in two parts, which is there before x, where one operation
 * rounds the product and the sum. So it is rounded as the quotient is, but for ties. */
static inline double tvi_quotient(double x, double divisor)
{
#ifdef __FMA__
    const double by = 1 / divisor, by_low = __builtin_fma(-by, divisor, 1) * by;
    return __builtin_fma(x, by, x * by_low);
#else
    return x / divisor;
#endif
}

/* The same of two. */
static inline jet_v2 tvi_quotients(jet_v2 x, double divisor)
{
#ifdef __FMA__
    const double by = 1 / divisor, by_low = __builtin_fma(-by, divisor, 1) * by;
    return _mm_fmadd_pd(x, _mm_set1_pd(by), x * by_low);
#else
    return x / divisor;
#endif
}

/* The quotients by k are of the coefficients and not of tau: the roundoff of tau / k would be the same in all steps,
 * and the energy would drift (docs/method.md section 6). For the same reason tau^2 / m is kappa tau. */
static inline void tvi_advance_separable(const tvi_recurrence *of, int k)
{
    const double divisor = (k + 1) * (k + 2), *field = of->x + (size_t)k * of->stride;
    double *next = of->x + (size_t)(k + 2) * of->stride;
    const int *at = of->output;
    int i = 0;
#ifdef JET_EMITTED
    for (; i + 2 <= of->n; i += 2) {
        const jet_v2 force = {field[at[i]], field[at[i + 1]]};
        *(jet_v2 *)(next + i) = tvi_quotients(*(const jet_v2 *)(of->kappa + i) * force * of->tau, divisor);
    }
#endif
    for (; i < of->n; i++) next[i] = tvi_quotient(of->kappa[i] * field[at[i]] * of->tau, divisor);
}

static inline void tvi_advance_hamiltonian(const tvi_recurrence *of, int k)
{
    const double divisor = k + 1, tau = of->tau, *field = of->x + (size_t)k * of->stride;
    double *q = of->x + (size_t)(k + 1) * of->stride, *p = q + of->n;
    for (int i = 0; i < of->n; i++) {
        q[i] = tvi_quotient(tau * field[of->output[of->n + i]], divisor);
        p[i] = tvi_quotient(-tau * field[of->output[i]], divisor);
    }
}

/* The same for tangents of `lanes` directions, of which x is the block; as vectors, of which the orders that follow
 * read them. */
#define TVI_ADVANCE_TANGENT(V, S) JET_AT(V, next, 0) = factor * JET_OF(V, field, 0);
static inline void tvi_advance_tangent(int lanes, double factor, const double *field, double *next)
{
    enum { stride = 0 };
    JET_BLOCKS(lanes, TVI_ADVANCE_TANGENT, );
}

static inline void tvi_tangents_separable(const tvi_recurrence *of, int k, int lanes)
{
    const double *field = of->x + (size_t)k * of->stride;
    double *next = of->x + (size_t)(k + 2) * of->stride;
    for (int i = 0; i < of->n; i++)
        tvi_advance_tangent(lanes, of->kappa[i] * of->tau / ((k + 1) * (k + 2)), field + of->output[i] * lanes,
                            next + i * lanes);
}

static inline void tvi_tangents_hamiltonian(const tvi_recurrence *of, int k, int lanes)
{
    const double factor = of->tau / (k + 1), *field = of->x + (size_t)k * of->stride;
    double *q = of->x + (size_t)(k + 1) * of->stride, *p = q + of->n * lanes;
    for (int i = 0; i < of->n; i++) {
        tvi_advance_tangent(lanes, factor, field + of->output[of->n + i] * lanes, q + i * lanes);
        tvi_advance_tangent(lanes, -factor, field + of->output[i] * lanes, p + i * lanes);
    }
}

#endif
