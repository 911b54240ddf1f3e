/* between.h - Computes the state inside the last step by a step of the method over a part of it. Runs call it at given
 * times and at events. The states are as accurate as steps; the curve of tvi_dense is of lower order. */
#ifndef TVI_SRC_RUN_BETWEEN_H
#define TVI_SRC_RUN_BETWEEN_H

#include "run/integrator.h"
#include "system/rates.h"

typedef struct {
    tvi_integrator *integrator;
    /* The integrator that makes the partial steps. It starts with the state and the history at the start of the last
     * step. */
    tvi_integrator *partial_integrator;
    /* The partial integrator uses the history at the end of the last step instead. That saves passes, and changes
     * roundoff. */
    bool knows_step;
    double t, *q, *p;    /* [n] the state that was computed last */
    tvi_rates rates;     /* of a rescaled system, in s */
    double *x, *rate;    /* scratch of `rates`: state [2 (n + 1) + 1] and its rates */
    long parameter_sets; /* the integrator's count when the partial one got its parameters */
    long step;           /* number of the step that the state belongs to; 0: none */
    double part;         /* part of h at which the state stands */
} tvi_between;

TVI_NODISCARD tvi_status tvi_between_open(tvi_between *between, tvi_integrator *steps, bool knows_step);
void tvi_between_close(tvi_between *between);

/* Copies the parameters of the last step to the partial integrator, if they have been set since. */
TVI_NODISCARD tvi_status tvi_between_set_parameters(tvi_between *between);

/* Computes the state `part` after the start of the last step, 0 <= part / h <= 1. At both ends it is the step's own
 * state, bit for bit. Fails as a step does. */
TVI_NODISCARD tvi_status tvi_between_state(tvi_between *between, double part);

/* Copies the state that was computed last into one vector x [2n + 1]: q, p, t. */
void tvi_between_copy(const tvi_between *between, double x[]);

/* Computes the state at a time of the last step, to roundoff of the time. */
TVI_NODISCARD tvi_status tvi_between_time(tvi_between *between, double time);

#endif
