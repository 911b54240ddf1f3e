/* advance.h - computes one order of a curve's recurrence (curve.c). It is part of the text of generated code, where
 * every size is a constant. */
#ifndef TVI_SRC_GENERATING_ADVANCE_H
#define TVI_SRC_GENERATING_ADVANCE_H

#include "fused.h"

typedef struct {
    int n;
    size_t stride;     /* the distance of orders in the block */
    const int *output; /* the slots of the field */
    double *x;         /* the block of the series */
    const double *kappa;
    double tau;
} tvi_recurrence;

/* Computes out = x / divisor, which the following orders wait for. It multiplies by the reciprocal in two parts, which
 * is known before x. The result is rounded as the quotient is, except for ties. This needs one operation that rounds
 * the product and the sum. */
#ifdef __FMA__
#define TVI_QUOTIENT(V, out, x, divisor)                                                                               \
    {                                                                                                                  \
        const double by = 1 / (divisor), by_low = JET_FMA_OF_NUMBERS(-by, divisor, 1) * by;                            \
        const V zero = {0}, dividend = x;                                                                              \
        out = JET_FMA(V, dividend, by + zero, dividend * by_low);                                                      \
    }
#else
#define TVI_QUOTIENT(V, out, x, divisor) out = (x) / (divisor);
#endif

/* These write vectors, since the orders that follow read vectors: a vector loaded from several numbers just stored
 * waits until they are in the cache. */
#define TVI_ADVANCE_SEPARABLE(V, S)                                                                                    \
    TVI_QUOTIENT(V, JET_AT(V, next, 0), JET_OF(V, of->kappa, 0) * JET_GATHER(V, field, of->output + here) * of->tau,   \
                 divisor)
#define TVI_ADVANCE_HAMILTONIAN(V, S)                                                                                  \
    {                                                                                                                  \
        TVI_QUOTIENT(V, JET_AT(V, q, 0), JET_GATHER(V, field, of->output + of->n + here) * tau, divisor)               \
        TVI_QUOTIENT(V, JET_AT(V, p, 0), JET_GATHER(V, field, of->output + here) * -tau, divisor)                      \
    }

/* The quotients by k are taken of the coefficients and not of tau: the roundoff of tau / k would be the same in all
 * steps, and the energy would drift (docs/method.md section 6). For this reason tau^2 / m is computed as kappa tau. */
static inline void tvi_advance_separable(const tvi_recurrence *of, int k)
{
    enum { stride = 0 };
    const double divisor = (k + 1) * (k + 2), *field = of->x + (size_t)k * of->stride;
    double *next = of->x + (size_t)(k + 2) * of->stride;
    JET_BLOCKS(of->n, TVI_ADVANCE_SEPARABLE, );
}

static inline void tvi_advance_hamiltonian(const tvi_recurrence *of, int k)
{
    enum { stride = 0 };
    const double divisor = k + 1, tau = of->tau, *field = of->x + (size_t)k * of->stride;
    double *q = of->x + (size_t)(k + 1) * of->stride, *p = q + of->n;
    JET_BLOCKS(of->n, TVI_ADVANCE_HAMILTONIAN, );
}

/* Advances the tangents of `lanes` directions, whose block is x, in whole vectors, since the orders that follow read
 * vectors. Their roundoff is that of small corrections, so that tau itself may be divided. */
#define TVI_ADVANCE_TANGENT(V, S) JET_AT(V, next, 0) = factor * JET_OF(V, field, 0);
static inline void tvi_advance_tangent(int lanes, double factor, const double *field, double *next)
{
    enum { stride = 0 };
    JET_BLOCKS(lanes, TVI_ADVANCE_TANGENT, );
}

static inline void tvi_tangents_separable(const tvi_recurrence *of, int k, int lanes)
{
    const double factor = of->tau / ((k + 1) * (k + 2)), *field = of->x + (size_t)k * of->stride;
    double *next = of->x + (size_t)(k + 2) * of->stride;
    for (int i = 0; i < of->n; i++)
        tvi_advance_tangent(lanes, of->kappa[i] * factor, field + of->output[i] * lanes, next + i * lanes);
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
