/* integrator.h - what an integrator holds between steps. */
#ifndef TVI_SRC_RUN_INTEGRATOR_H
#define TVI_SRC_RUN_INTEGRATOR_H

#include "method/stepper.h"

/* The scalars of the history; its vectors are below. */
typedef struct {
    double t, t_low;
    long continues; /* t, q, p hold what the last successful step returned */
} tvi_last_step;

/* What tvi_step_tangent needs, made when it is first called (tangent.c). */
typedef struct tvi_tangent tvi_tangent;
void tvi_tangent_free(tvi_tangent *tangent); /* NULL is allowed */

struct tvi_integrator {
    const tvi_system *system;
    tvi_options options; /* as resolved */
    tvi_stats stats;
    const tvi_stepper *stepper;
    void *work;
    char *history, *before;      /* [remembered] all that one step leaves to the next; before the last one was tried */
    size_t remembered, of_state; /* of_state: what comes before the stepper's part of it */
    tvi_last_step *last;         /* in the history, as are */
    double *q, *p, *q_low, *p_low; /* [n] */
    bool has_dense;                /* the work holds the last step */
    bool continued;                /* it began with what the one before it returned */
    double h;                      /* its size, and where it started */
    double t_start, t_start_low, *q_start, *p_start;
    double *dq, *dp;      /* [n] */
    tvi_tangent *tangent; /* NULL: never asked for */
};

/* Another one for the same system and options, which has made no step. */
TVI_NODISCARD tvi_status tvi_integrator_twin(tvi_integrator **out, const tvi_integrator *integrator);

/* The time at theta of the last step. */
double tvi_time_at(const tvi_integrator *integrator, double theta);

/* The states at the sample places of the last step (stepper.h), as a tape with a lane for each wants them: q, p and t
 * in x [2n + 1][TVI_SAMPLES]. The one at the end is that of the step. They may not be finite. */
void tvi_sample(tvi_integrator *integrator, double *x);

#endif
