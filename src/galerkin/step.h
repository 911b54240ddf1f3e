/* step.h - Declares the stepper of the Galerkin curve (galerkin.c). The stepper of several members uses it, too
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
    galerkin_roundoff_probe probe;
    tvi_passes_rule passes_rule;
    galerkin_node_polynomials node_polynomials;
    /* [2n] The factors of the sums of impulses in the increments of q and p. */
    double *increment_scale;
    galerkin_tail_inputs tail_inputs;
    galerkin_step_data step_data; /* points to the members above */
    /* The system's generated code, or NULL if there is none. */
    const galerkin_code *generated_code;
} galerkin_stepper;

/* Computes the weights and scales of the nodes for the step h, if it differs from the last one. */
void tvi_galerkin_set_step_size(galerkin_stepper *stepper, double h);

/* These functions are tvi_stepper.dense and tvi_stepper.sample of the Galerkin curve. */
void tvi_galerkin_compute_dense_output(void *work, double theta, double dq[], double dp[]);
void tvi_galerkin_compute_samples(void *work, const tvi_component_range used_range[2], const double q_start[],
                                  const double p_start[], double *q, double *p);

/* Returns whether the passes of this system use no second derivatives. */
bool tvi_galerkin_needs_no_hessian(const tvi_system *system);

#endif
