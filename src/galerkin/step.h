/* step.h - Declares the work of a step of the Galerkin curve (galerkin.c), which the steps of several members share
 * (batch.c). */
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
    double *drift, *drift_low; /* [unknowns] h M^-1 p0 of a separable system, in two parts; otherwise 0 */
    double *share, *ratio;     /* [n] of the tail */
    double *rise;              /* [2n] factors of the integrals of the impulses in q and p */
    galerkin_tail_inputs tail_inputs;
    galerkin_frame frame;      /* refers to the members above */
    const galerkin_code *code; /* also makes steps; NULL: the library alone does */
} galerkin;

/* Sets the weights and scales of the nodes, which depend on the size of the step alone. */
void tvi_galerkin_set_size(galerkin *w, double h);

/* Define tvi_stepper.dense and .sample. */
void tvi_galerkin_dense(void *work, double theta, double dq[], double dp[]);
void tvi_galerkin_sample(void *work, const tvi_component_range used[2], const double q_start[], const double p_start[],
                         double *q, double *p);

/* Tells whether the system's passes know no second derivatives. */
bool tvi_galerkin_is_plain(const tvi_system *system);

#endif
