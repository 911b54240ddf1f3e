/* rates.h - the derivatives of a state by the time. */
#ifndef TVI_SRC_SYSTEM_RATES_H
#define TVI_SRC_SYSTEM_RATES_H

#include "system/system.h"

typedef struct {
    const tvi_system *system;
    double *block; /* of the field at one point; NULL: the system states none in q and p */
} tvi_rates;

/* Of a Lagrangian there are none. */
TVI_NODISCARD tvi_status tvi_rates_open(tvi_rates *rates, const tvi_system *system, const double parameters[]);
void tvi_rates_set_parameters(tvi_rates *rates, const double parameters[]);
void tvi_rates_close(tvi_rates *rates);

/* rate [2n] of q and p at the state x [2n + 1] of q, p and t. TVI_EDOMAIN. */
TVI_NODISCARD tvi_status tvi_rates_at(tvi_rates *rates, const double x[], double rate[]);

#endif
