/* emitted_curve.h - the series of generated code (emit.c), which alone reads this, after advance.h and the sweeps of
 * the tape tvi_series. ADVANCE makes the coefficients that are RISE orders above the field's, and TANGENTS theirs, in
 * LANES directions. */
#ifndef TVI_SRC_GENERATING_EMITTED_CURVE_H
#define TVI_SRC_GENERATING_EMITTED_CURVE_H

#include "generating/advance.h"

#define CURVE_EXPAND(k)                                                                                                \
    if ((k) + RISE <= tvi_series_top) {                                                                                \
        inside &= tvi_series_series_of(x, (k), 1);                                                                     \
        ADVANCE(&of, (k));                                                                                             \
    }

#define CURVE_DIFFERENTIATE(k)                                                                                         \
    if ((k) + RISE <= tvi_series_top) {                                                                                \
        tvi_series_tangents_of(x, dx, (k), LANES);                                                                     \
        TANGENTS(&of, (k), LANES);                                                                                     \
    }

#define CURVE_EMITTED_EXPAND(NAME, N)                                                                                  \
    static bool NAME##_expand(double *x, const double *kappa, double tau)                                              \
    {                                                                                                                  \
        const tvi_recurrence of = {(N), (size_t)tvi_series.slots, NAME##_output, x, kappa, tau};                       \
        bool inside = true;                                                                                            \
        tvi_series_ORDERS(CURVE_EXPAND) return inside;                                                                 \
    }

#define CURVE_EMITTED_DIFFERENTIATE(NAME, N)                                                                           \
    static void NAME##_differentiate(const double *x, double *dx, const double *kappa, double tau)                     \
    {                                                                                                                  \
        const tvi_recurrence of = {(N), (size_t)(tvi_series.slots * LANES), NAME##_output, dx, kappa, tau};            \
        tvi_series_ORDERS(CURVE_DIFFERENTIATE)                                                                         \
    }

#endif
