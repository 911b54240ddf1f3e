/* step.h - what a step of the Galerkin curve is made with (galerkin.c), for those of several members, too (batch.c). */
#ifndef TVI_SRC_GALERKIN_STEP_H
#define TVI_SRC_GALERKIN_STEP_H

#include "galerkin/predictor.h"
#include "galerkin/probe.h"
#include "galerkin/steps.h"

typedef struct {
    const tvi_options *options;
    int n;
    galerkin_field field;
    galerkin_coefficients coefficients;
    galerkin_predictor predictor;
    galerkin_probe probe;
    tvi_passes_rule rule;
    galerkin_dense dense;
    double *drift, *drift_low; /* [unknowns] h M^-1 p0 of a separable system, in two parts; else 0 */
    double *share, *ratio;     /* [n] of the tail */
    double *rise;              /* [2n] what multiplies the integrals of the impulses in q and p */
    galerkin_motion motion;
    galerkin_frame frame;      /* of what stands above */
    const galerkin_code *code; /* which makes steps, too; NULL: the library alone does */
} galerkin;

/* What depends on the size of the step alone: the weights and scales of the nodes. */
void tvi_galerkin_set_size(galerkin *w, double h);

/* tvi_stepper.dense and .sample. */
void tvi_galerkin_dense(void *work, double theta, double dq[], double dp[]);
void tvi_galerkin_sample(void *work, const tvi_range of[2], const double q_start[], const double p_start[], double *q,
                         double *p);

/* Whether its passes know no second derivatives. */
bool tvi_galerkin_is_plain(const tvi_system *system);

#endif
