/* rates.h - Computes the time derivatives of a state. States at given times and the finder of events call it. */
#ifndef TVI_SRC_SYSTEM_RATES_H
#define TVI_SRC_SYSTEM_RATES_H

#include "system/system.h"

typedef struct {
    const tvi_system *system;
    /* Block of the field at one point; NULL if the field is not given in q and p. */
    double *block;
} tvi_rates;

/* Opens the rates. A Lagrangian has none: `block` is NULL then. */
TVI_NODISCARD tvi_status tvi_rates_open(tvi_rates *rates, const tvi_system *system, const double parameters[]);
void tvi_rates_set_parameters(tvi_rates *rates, const double parameters[]);
void tvi_rates_close(tvi_rates *rates);

/* Computes rate [2n] of q and p at the state x [2n + 1] of q, p and t. TVI_EDOMAIN. */
TVI_NODISCARD tvi_status tvi_rates_at(tvi_rates *rates, const double x[], double rate[]);

#endif
