/* partial_step.h - Computes a state inside the last step of an integrator, by a shorter step of the same method from
 * the start of that step. Runs call it for results at given times (run/times.c), for events (events/) and for the end
 * of a run (run/run.c). The computed states are as accurate as those at the ends of steps; the curve of tvi_dense is
 * less accurate. */
#ifndef TVI_INTEGRATOR_PARTIAL_STEP_H
#define TVI_INTEGRATOR_PARTIAL_STEP_H

#include "integrator/integrator.h"
#include "system/rates.h"

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
    double t, *q, *p;                    /* the state (t, q[n], p[n]) that was computed last */
    tvi_rates_evaluator rates_evaluator; /* evaluates dq/ds and dp/ds of a rescaled system; unused otherwise */
    /* Scratch memory: a state [2(n+1)+1] of a rescaled system, and its derivatives by s [2(n+1)]. */
    double *rates_input, *rates_output;
    long copied_parameter_version; /* full_step_integrator->parameter_version when the parameters were last copied */
    long full_step_number;         /* the number of the full step that the state lies in; 0 if there is no state */
    /* The distance, 0 to h, of the state (t, q, p) from the start of the full step. */
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

/* Copies the state that was computed last to one vector [2n + 1], in the order q, p, t. */
void tvi_partial_step_copy_state(const tvi_partial_step *partial_step, double state[]);

/* Computes the state at the given time, which must lie in the last full step. The time of the computed state agrees
 * with `time` to roundoff. */
TVI_NODISCARD tvi_status tvi_partial_step_to_time(tvi_partial_step *partial_step, double time);

#endif
