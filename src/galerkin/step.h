/* step.h - Declares the stepper of the Galerkin curve (galerkin.c), and the functions that predict its unknowns
 * (predictor.c), measure roundoff (probe.c) and evaluate its curve (places.c). */
#ifndef TVI_SRC_GALERKIN_STEP_H
#define TVI_SRC_GALERKIN_STEP_H

#include "galerkin/coefficients.h"
#include "galerkin/field.h"
#include "galerkin/steps.h"
#include "system/roundoff.h"

/* ---- The prediction of the unknowns from earlier steps (predictor.c; docs/method.md section 5) ------------------ */

/* The history of the last two steps, from which the next one is predicted. The integrator's history stores this
 * structure and the impulses. */
typedef struct {
    /* The sizes of the last step and of the step before it; 0 if there is none. */
    double last_step_size, previous_step_size;
    double last_step_start_time; /* the time at which the last step began */
    /* The convergence of the last step's passes, or of earlier ones if the last passes do not show it. */
    galerkin_convergence convergence;
    long last_ring_index; /* the index of the last step's impulses in impulse_ring */
} galerkin_history;

/* Returns true if last_ring_index, read from a saved state, is an index of the impulse ring. */
static inline bool galerkin_is_ring_index_valid(long last_ring_index)
{
    return last_ring_index >= 0 && last_ring_index < GALERKIN_RING_LENGTH;
}

typedef struct {
    galerkin_history *history;
    /* The impulses of the last steps, [unknowns][lanes] each, stored in the history as a ring buffer. */
    double *impulse_ring[GALERKIN_RING_LENGTH];
    /* The factors [2][j][i] of the impulses of the last two steps, and [j][i] of the last step, in the predicted
     * unknowns of the next step, or in h times their rates. All these steps have the same size h. */
    double *two_step_extrapolation, *last_step_extrapolation;
    /* The limit of the movement of the first pass of a step, a sum of squares. If the movement is larger, the
     * prediction of the step had a relative error above 1/100, and the next step is predicted from the last step
     * alone. */
    double two_step_prediction_max_first_movement;
    /* [j][lanes] The factors of the last step's impulses in the rates of a step that is new_to_last_step_size_ratio
     * times as large and begins at the fraction resized_step_elapsed_fraction of the last step. */
    double *resized_step_extrapolation;
    /* The step for which resized_step_extrapolation was computed. The ratio is 0 before the first computation. */
    double new_to_last_step_size_ratio, resized_step_elapsed_fraction;
    /* [unknowns][lanes] The rates that were extrapolated from the last step. */
    double *extrapolated_rates;
    double *zeros, *ones; /* [unknowns + lanes] vectors of zeros and of ones */
} galerkin_predictor;

void tvi_galerkin_allocate_predictor(galerkin_predictor *predictor, tvi_arena *arena,
                                     const galerkin_equations *equations);
void tvi_galerkin_set_predictor_tables(galerkin_predictor *predictor, const galerkin_coefficients *coefficients,
                                       const galerkin_equations *equations);
/* Returns whether a step of size h from time t begins where the last step ended. */
static inline bool galerkin_follows_last_step(const galerkin_history *history, double h, double t)
{
    return fabs(t - (history->last_step_start_time + history->last_step_size)) < GALERKIN_MAX_TIME_GAP * fabs(h);
}

/* Returns whether the last step can predict a step of the field's size from time t, because its nodes are near those of
 * the last step. *elapsed_fraction is the fraction of the last step at which the new step begins: 1 for its end, 0 for
 * its start. */
bool tvi_galerkin_can_predict_from_last_step(const galerkin_predictor *predictor, const galerkin_equations *equations,
                                             double t, double *elapsed_fraction);
/* Predicts the field's unknowns from the last step, which has another size or starts elsewhere. */
void tvi_galerkin_predict_from_last_step(galerkin_predictor *predictor, const galerkin_coefficients *coefficients,
                                         const galerkin_node_polynomials *polynomials, galerkin_equations *equations,
                                         double elapsed_fraction);
/* Returns the impulses of the last step if steps_after_last is 0, of an earlier step if it is negative, and of the next
 * step if it is 1. */
static inline double *galerkin_find_impulses_of_step(const galerkin_predictor *predictor, int steps_after_last)
{
    return predictor->impulse_ring[(predictor->history->last_ring_index + steps_after_last + GALERKIN_RING_LENGTH) %
                                   GALERKIN_RING_LENGTH];
}

/* ---- The rules that end passes, and the roundoff of a pass (probe.c; docs/method.md section 5) ------------------- */

/* The memory for measuring the roundoff of a pass. */
typedef struct {
    tvi_roundoff_estimator tape_output_roundoff;
    /* [node_value_row_count_read_by_pass][lanes] The rows of nodes.values before a pass, and after a pass from
     * displaced values. */
    double *values_before_pass, *values_after_displaced_pass;
    /* [unknowns][lanes] Copies of drift_values_low and of the impulses of the nodes. */
    double *saved_drift_values_low, *saved_impulses;
} galerkin_roundoff_probe;

void tvi_galerkin_allocate_probe(galerkin_roundoff_probe *probe, tvi_arena *arena, const galerkin_equations *equations);

/* Returns the rule that ends the passes of a step, from the rule for one unknown at one node and from the user's
 * options. unknown_value_count is the number of unknowns times the number of lanes. */
tvi_stopping_rule tvi_galerkin_scale_passes_rule(const tvi_stopping_rule *rule_per_unknown, int unknown_value_count,
                                                 const tvi_options *options);

/* Returns whether the nodes are still near the start of the step (tvi_roundoff_may_exceed_step_motion of roundoff.h),
 * and have not diverged. */
bool tvi_galerkin_are_nodes_near_start(const galerkin_equations *equations, const tvi_step_origin *origin);

/* Makes the next pass, which moves the unknowns by *movement, and measures its roundoff: the difference from a pass
 * with displaced unknowns and displaced values of the field. Both results are sums of squares, as the passes measure
 * movements. */
TVI_NODISCARD tvi_status tvi_galerkin_measure_roundoff(galerkin_equations *equations, galerkin_roundoff_probe *probe,
                                                       double *movement, double *roundoff, tvi_stats *stats);

/* ---- The stepper ------------------------------------------------------------------------------------------------- */

typedef struct {
    const tvi_options *options;
    int n;
    galerkin_equations equations;
    galerkin_coefficients coefficients;
    galerkin_predictor predictor;
    galerkin_roundoff_probe probe;
    tvi_stopping_rule passes_rule;
    galerkin_node_polynomials node_polynomials;
    /* [2n] The factors of the sums of impulses in the increments of q and p. */
    double *increment_per_impulse;
    galerkin_tail_inputs tail_inputs;
    galerkin_step_inputs step_inputs; /* pointers to the parts of this stepper, for steps.h */
    /* The system's generated code, or NULL if there is none. */
    const galerkin_generated_code *generated_code;
} galerkin_stepper;

/* Computes the weights and scales of the nodes for the step size h, if h differs from the size of the last step. */
void tvi_galerkin_set_step_size(galerkin_stepper *stepper, double h);

/* The functions `interpolate` and `sample` of tvi_stepper, for the Galerkin curve of the last step. */
void tvi_galerkin_compute_dense_output(void *work, double theta, double dq[], double dp[]);
void tvi_galerkin_compute_curve_samples(void *work, const tvi_component_range used_range[2], const double q_start[],
                                        const double p_start[], double *q, double *p);

#endif
