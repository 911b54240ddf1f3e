/* between.h - the state inside the last step, by a step of the method of a part of its size: as good as the steps,
 * where the curve of tvi_dense is of lower order. */
#ifndef TVI_SRC_RUN_BETWEEN_H
#define TVI_SRC_RUN_BETWEEN_H

#include "run/integrator.h"
#include "system/rates.h"

typedef struct {
    tvi_integrator *steps;
    tvi_integrator *partial; /* starts where the last step did, with what was known there, */
    bool knows_step;         /* or what its stepper knew after it: fewer passes, and another roundoff */
    double t, *q, *p;        /* [n] the state asked for last: */
    tvi_rates rates;         /* of a rescaled system, in s, */
    double *x, *rate;        /* and where they are asked, [2 (n + 1) + 1] each */
    long parameter_sets;     /* of `steps`, when its parameters were those here */
    long step;               /* of this step, 0 = none */
    double part;             /* here */
} tvi_between;

TVI_NODISCARD tvi_status tvi_between_open(tvi_between *between, tvi_integrator *steps, bool knows_step);
void tvi_between_close(tvi_between *between);

/* Makes the parameters those of the last step, where they have been set since. */
TVI_NODISCARD tvi_status tvi_between_set_parameters(tvi_between *between);

/* The state `part` after the start of the last step, 0 <= part / h <= 1; its ends are those of the step, bit for bit.
 * Fails as a step does. */
TVI_NODISCARD tvi_status tvi_between_state(tvi_between *between, double part);

/* The state asked for last, as one vector x [2n + 1]: q, p, t. */
void tvi_between_copy(const tvi_between *between, double x[]);

/* The state at a time of the last step, to roundoff of the time. */
TVI_NODISCARD tvi_status tvi_between_time(tvi_between *between, double time);

#endif
