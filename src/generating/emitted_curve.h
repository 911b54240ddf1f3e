/* emitted_curve.h - the series of generated code (emit.c), which alone reads this, after advance.h and the sweeps of
 * the tape `series`. ADVANCE makes the coefficients that are RISE orders above the field's. */
#ifndef TVI_SRC_GENERATING_EMITTED_CURVE_H
#define TVI_SRC_GENERATING_EMITTED_CURVE_H

#include "generating/advance.h"

#define CURVE_EMITTED_ORDER(k)                                                                                         \
    if ((k) + RISE <= series_top) {                                                                                    \
        inside &= series_series_of(x, (k), 1);                                                                         \
        ADVANCE(&of, (k));                                                                                             \
    }

#define CURVE_EMITTED(NAME, N)                                                                                         \
    static bool NAME##_expand(double *x, const double *kappa, double tau)                                              \
    {                                                                                                                  \
        const tvi_recurrence of = {(N), (size_t)series.slots, NAME##_output, x, kappa, tau};                           \
        bool inside = true;                                                                                            \
        series_ORDERS(CURVE_EMITTED_ORDER) return inside;                                                              \
    }                                                                                                                  \
    static const tvi_curve_code NAME = {series_top, NAME##_expand};

#endif
