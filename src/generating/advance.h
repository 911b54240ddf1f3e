/* advance.h - computes one order of the recurrence for the coefficients of a Taylor curve (docs/method.md section
 * 2). orders.h calls it. Generated code includes this text (emit.c) with every size as a constant. */
#ifndef TVI_SRC_GENERATING_ADVANCE_H
#define TVI_SRC_GENERATING_ADVANCE_H

#include "fused.h"

typedef struct {
    int n, width;
    size_t order_stride;   /* the distance from one order to the next in the block */
    const int *field_slot; /* the slots of the field's outputs */
    double *series_block;  /* the block of the series, or of its tangents */
    const double *kappa;
    double tau;
} tvi_series_recurrence;

/* Computes out = x / divisor, by a multiplication with the reciprocal of the divisor. The reciprocal is kept in two
 * parts, and is known before x is; thus the following orders wait for x only. Rounding is that of a division, except
 * for ties. It needs a fused multiply-add. */
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

/* TVI_ADVANCE_SEPARABLE and TVI_ADVANCE_HAMILTONIAN store whole vectors, since the next orders load whole vectors: a
 * load that covers several short stores has to wait for the cache. */
#define TVI_ADVANCE_SEPARABLE(V, S)                                                                                    \
    TVI_QUOTIENT(V, JET_AT(V, next, 0),                                                                                \
                 JET_OF(V, recurrence->kappa, 0) * JET_GATHER(V, field, recurrence->field_slot + here) *               \
                     recurrence->tau,                                                                                  \
                 divisor)
/* Advances component i of all members. */
#define TVI_ADVANCE_COMPONENT_OF_MEMBERS(V, S)                                                                         \
    TVI_QUOTIENT(V, JET_AT(V, next, i), kappa *JET_OF(V, field, slot) * tau, divisor)
static inline void tvi_advance_component_of_members(const tvi_series_recurrence *recurrence, double kappa, double tau,
                                                    double divisor, const double *field, int slot, double *next, int i)
{
    const size_t stride = (size_t)recurrence->width;
    JET_BLOCKS(recurrence->width, TVI_ADVANCE_COMPONENT_OF_MEMBERS, );
}
#define TVI_ADVANCE_HAMILTONIAN(V, S)                                                                                  \
    {                                                                                                                  \
        TVI_QUOTIENT(V, JET_AT(V, q, 0), JET_GATHER(V, field, recurrence->field_slot + recurrence->n + here) * tau,    \
                     divisor)                                                                                          \
        TVI_QUOTIENT(V, JET_AT(V, p, 0), JET_GATHER(V, field, recurrence->field_slot + here) * -tau, divisor)          \
    }

/* The coefficients are divided by k, and not tau: tau / k would have the same roundoff in every step, and the energy
 * would drift (docs/method.md section 6). For this reason tau^2 / m is computed as kappa tau. */
static inline void tvi_advance_separable(const tvi_series_recurrence *recurrence, int k)
{
    enum { stride = 0 };
    const double divisor = (k + 1) * (k + 2), *field = recurrence->series_block + (size_t)k * recurrence->order_stride;
    double *next = recurrence->series_block + (size_t)(k + 2) * recurrence->order_stride;
    if (recurrence->width == 1) JET_BLOCKS(recurrence->n, TVI_ADVANCE_SEPARABLE, );
    for (int i = 0; recurrence->width > 1 && i < recurrence->n; i++)
        tvi_advance_component_of_members(recurrence, recurrence->kappa[i], recurrence->tau, divisor, field,
                                         recurrence->field_slot[i], next, i);
}

static inline void tvi_advance_hamiltonian(const tvi_series_recurrence *recurrence, int k)
{
    enum { stride = 0 };
    const double divisor = k + 1, tau = recurrence->tau,
                 *field = recurrence->series_block + (size_t)k * recurrence->order_stride;
    double *q = recurrence->series_block + (size_t)(k + 1) * recurrence->order_stride, *p = q + recurrence->n;
    const int n = recurrence->n, *output = recurrence->field_slot;
    if (recurrence->width == 1) JET_BLOCKS(n, TVI_ADVANCE_HAMILTONIAN, );
    for (int i = 0; recurrence->width > 1 && i < n; i++) {
        tvi_advance_component_of_members(recurrence, 1, tau, divisor, field, output[n + i], q, i);
        tvi_advance_component_of_members(recurrence, 1, -tau, divisor, field, output[i], q, n + i);
    }
}

/* Computes next = factor * field, of one component's tangents in `lanes` directions, in whole vectors, since the next
 * orders load vectors. Tangents only give small corrections, so that their factor may contain the rounded tau / k. */
#define TVI_ADVANCE_TANGENT(V, S) JET_AT(V, next, 0) = factor * JET_OF(V, field, 0);
static inline void tvi_advance_tangent_row(int lanes, double factor, const double *field, double *next)
{
    enum { stride = 0 };
    JET_BLOCKS(lanes, TVI_ADVANCE_TANGENT, );
}

static inline void tvi_advance_separable_tangents(const tvi_series_recurrence *recurrence, int k, int lanes)
{
    const double factor = recurrence->tau / ((k + 1) * (k + 2)),
                 *field = recurrence->series_block + (size_t)k * recurrence->order_stride;
    double *next = recurrence->series_block + (size_t)(k + 2) * recurrence->order_stride;
    for (int i = 0; i < recurrence->n; i++)
        tvi_advance_tangent_row(lanes, recurrence->kappa[i] * factor, field + recurrence->field_slot[i] * lanes,
                                next + i * lanes);
}

static inline void tvi_advance_hamiltonian_tangents(const tvi_series_recurrence *recurrence, int k, int lanes)
{
    const double factor = recurrence->tau / (k + 1),
                 *field = recurrence->series_block + (size_t)k * recurrence->order_stride;
    double *q = recurrence->series_block + (size_t)(k + 1) * recurrence->order_stride, *p = q + recurrence->n * lanes;
    for (int i = 0; i < recurrence->n; i++) {
        tvi_advance_tangent_row(lanes, factor, field + recurrence->field_slot[recurrence->n + i] * lanes,
                                q + i * lanes);
        tvi_advance_tangent_row(lanes, -factor, field + recurrence->field_slot[i] * lanes, p + i * lanes);
    }
}

#endif
