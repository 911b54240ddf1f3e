/* inside_step.h - Computes states inside the last step of an integrator: on the curve of the step (tvi_dense), and by a
 * shorter step of the same method from the start of that step. The curve costs little, and the shorter step is as
 * accurate as those at the ends of steps. Runs call it for results at given times (run/times.c), for events (events/)
 * and for the end of a run (run/end.c). theta is the part of the step, from 0 at its start to 1 at its end. */
#ifndef TVI_INTEGRATOR_INSIDE_STEP_H
#define TVI_INTEGRATOR_INSIDE_STEP_H

#include "integrator/integrator.h"

/* Copies a state of an integrator to one vector [2n + 1], in the order q, p, t. */
void tvi_run_state_to_vector(const tvi_run_state *from, int n, double state[]);

/* ---- On the curve ------------------------------------------------------------------------------------------------ */

/* Computes the state of tvi_dense and its time: the state on the curve of the last step at theta. */
TVI_NODISCARD tvi_status tvi_evaluate_dense_output(tvi_integrator *integrator, double theta, double *t, double q[],
                                                   double p[]);

/* Computes the states on the curve of the last step at all sample points (tvi_sample_theta), for the evaluation of
 * events: samples[2n + 1][TVI_SAMPLES], in the order q, p, t. Only the components used_components[0] of q and
 * used_components[1] of p, and t, are set; others may be overwritten. The last sample is the end of the step itself.
 * The states may not be finite. */
void tvi_sample_dense_output(tvi_integrator *integrator, const tvi_component_range used_components[2], double *samples);

/* ---- By a shorter step ------------------------------------------------------------------------------------------- */

/* The integrator of the run, a second integrator that repeats a part of its last step, and the state that was computed
 * last. */
typedef struct {
    tvi_integrator *full_step_integrator; /* the integrator of the run, which has made a step of size h */
    /* The integrator that makes the partial steps. It starts from the state and the history at the start of the last
     * full step. */
    tvi_integrator *partial_step_integrator;
    /* If true, the corrector of a partial step begins with what it had learned by the end of the full step, and not
     * with what it knew at the start of that step. This saves passes, but changes the roundoff of the results. */
    bool uses_history_after_step;
    double *state;                 /* [2n + 1] the state that was computed last, in the order q, p, t */
    long copied_parameter_version; /* full_step_integrator->parameter_version when the parameters were last copied */
    long full_step_number;         /* the number of the full step that the state lies in; 0 if there is no state */
    /* The distance, 0 to h, of the state from the start of the full step. */
    double stored_state_offset;
} tvi_partial_step;

/* Creates the integrator for the partial steps, and allocates the memory. */
TVI_NODISCARD tvi_status tvi_partial_step_open(tvi_partial_step *partial_step, tvi_integrator *full_step_integrator,
                                               bool uses_history_after_step);
void tvi_partial_step_close(tvi_partial_step *partial_step);

/* Copies the parameters of the last full step to the integrator of the partial steps, if they have changed since the
 * last copy. */
TVI_NODISCARD tvi_status tvi_partial_step_set_parameters(tvi_partial_step *partial_step);

/* Computes the state at the given offset from the start of the last full step of size h, 0 <= offset / h <= 1. At
 * offsets 0 and h it returns the state of the full step itself, bit for bit. It fails with the statuses of tvi_step. */
TVI_NODISCARD tvi_status tvi_partial_step_compute_state(tvi_partial_step *partial_step, double offset);

/* Computes the state at the given time, which must lie in the last full step. The time of the computed state agrees
 * with `time` to roundoff. */
TVI_NODISCARD tvi_status tvi_partial_step_to_time(tvi_partial_step *partial_step, double time);

#endif
