/* rates.h - Computes the time derivatives q' and p' of a state. States at given times, and the search for events,
 * call it. */
#ifndef TVI_SRC_SYSTEM_RATES_H
#define TVI_SRC_SYSTEM_RATES_H

#include "system/system.h"

/* The memory in which q' and p' are computed. */
typedef struct {
    const tvi_system *system;
    /* The block of the field at one point. NULL for a Lagrangian, whose field is not a function of q and p. */
    double *field_block;
} tvi_rates_evaluator;

/* Allocates the memory, and sets the parameters. For a Lagrangian, `field_block` stays NULL. */
TVI_NODISCARD tvi_status tvi_state_rates_open(tvi_rates_evaluator *rates, const tvi_system *system,
                                              const double parameters[]);
void tvi_state_rates_set_parameters(tvi_rates_evaluator *rates, const double parameters[]);
void tvi_state_rates_close(tvi_rates_evaluator *rates);

/* Computes rate [2n] = (q', p') at the state x [2n + 1] = (q, p, t). Returns TVI_EDOMAIN if the field has no
 * value there. */
TVI_NODISCARD tvi_status tvi_state_rates_compute(tvi_rates_evaluator *rates, const double x[], double rate[]);

#endif
