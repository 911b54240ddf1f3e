/* partial_step.c - Computes states inside the last step, at a given offset from its start or at a given time
 * (partial_step.h). */
#include "integrator/partial_step.h"
#include "algebra/narrow.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* [corrections] The size of a partial step is corrected at most this often. */
#define PARTIAL_STEP_MAX_CORRECTIONS 12 /* found: make check-events */
/* [h] Partial steps whose sizes differ by less have nearly the same nodes and can use each other's history. */
#define PARTIAL_STEP_NEAR 1e-3 /* found: make check-events */

tvi_status tvi_partial_step_open(tvi_partial_step *partial_step, tvi_integrator *full_step_integrator,
                                 bool uses_history_after_step)
{
    const size_t n = (size_t)full_step_integrator->system->n, wide = 2 * (n + 1) + 1;
    *partial_step = (tvi_partial_step){.full_step_integrator = full_step_integrator,
                                       .uses_history_after_step = uses_history_after_step,
                                       .copied_parameter_version = full_step_integrator->parameter_version};
    partial_step->q = calloc(2 * n + 2 * wide, sizeof *partial_step->q);
    if (!partial_step->q) return jet_explain_out_of_memory(TVI_ENOMEM);
    partial_step->p = partial_step->q + n;
    partial_step->rates_input = partial_step->p + n;
    partial_step->rates_output = partial_step->rates_input + wide;
    tvi_status status = tvi_integrator_create_like(&partial_step->partial_step_integrator, full_step_integrator);
    if (status == TVI_OK && tvi_is_rescaled(full_step_integrator))
        status = tvi_state_rates_open(&partial_step->rates_evaluator, full_step_integrator->system->stepped_system,
                                      full_step_integrator->parameters);
    if (status != TVI_OK) tvi_partial_step_close(partial_step);
    return jet_explain_out_of_memory(status);
}

void tvi_partial_step_close(tvi_partial_step *partial_step)
{
    tvi_integrator_free(partial_step->partial_step_integrator);
    tvi_state_rates_close(&partial_step->rates_evaluator);
    free(partial_step->q);
    *partial_step = (tvi_partial_step){0};
}

tvi_status tvi_partial_step_set_parameters(tvi_partial_step *partial_step)
{
    const tvi_integrator *it = partial_step->full_step_integrator;
    if (partial_step->copied_parameter_version == it->parameter_version) return TVI_OK;
    partial_step->copied_parameter_version = it->parameter_version;
    partial_step->full_step_number = 0;
    if (partial_step->rates_evaluator.field_block)
        tvi_state_rates_set_parameters(&partial_step->rates_evaluator, it->parameters);
    return tvi_integrator_set_parameters(partial_step->partial_step_integrator, it->parameters);
}

/* Sets the history from which the partial step of size `offset` starts. It has two parts. The first part, the state
 * with its low-order parts, is always copied from the start of the full step. The second part is what the corrector has
 * learned, from which it predicts its unknowns. If uses_history_after_step is false, this part, too, is copied from the
 * start of the full step. If it is true, this part is copied from the end of the full step; but if the last partial
 * step began at the same full step and had almost the size `offset`, this part is kept as that partial step left it.
 * tvi_step goes on from it, since the copied is_state_from_step is that of the full step's start; where the full step
 * was the first one of a run that is 0, and the history is cleared. */
static void set_partial_step_history(tvi_partial_step *partial_step, double offset)
{
    const tvi_integrator *it = partial_step->full_step_integrator;
    const size_t state = partial_step->uses_history_after_step ? it->history.state_bytes : it->history.copied_bytes;
    const bool is_near = partial_step->uses_history_after_step && partial_step->full_step_number == it->stats.steps &&
                         partial_step->stored_state_offset != it->last_step.h &&
                         partial_step->stored_state_offset != 0 &&
                         fabs(offset - partial_step->stored_state_offset) < PARTIAL_STEP_NEAR * fabs(it->last_step.h);
    tvi_arena_copy_history(partial_step->partial_step_integrator->history.now, it->history.before, state);
    if (!is_near)
        tvi_arena_copy_history(partial_step->partial_step_integrator->history.now + state, it->history.now + state,
                               it->history.bytes - state);
}

tvi_status tvi_partial_step_compute_state(tvi_partial_step *partial_step, double offset)
{
    const tvi_integrator *it = partial_step->full_step_integrator;
    const size_t bytes = (size_t)it->system->n * sizeof *partial_step->q;
    const bool is_end = offset == it->last_step.h;
    if (partial_step->full_step_number == it->stats.steps && partial_step->stored_state_offset == offset) return TVI_OK;
    const tvi_run_state *state = is_end ? &it->state : &it->last_step.start;
    partial_step->t = state->q[it->system->n];
    memcpy(partial_step->q, state->q, bytes);
    memcpy(partial_step->p, state->p, bytes);
    if (!is_end && offset != 0) {
        set_partial_step_history(partial_step, offset);
        partial_step->full_step_number = 0;
        const tvi_status status =
            tvi_step(partial_step->partial_step_integrator, offset, &partial_step->t, partial_step->q, partial_step->p);
        if (status != TVI_OK) return status;
    }
    partial_step->full_step_number = it->stats.steps;
    partial_step->stored_state_offset = offset;
    return TVI_OK;
}

void tvi_partial_step_copy_state(const tvi_partial_step *partial_step, double state[])
{
    const size_t n = (size_t)partial_step->full_step_integrator->system->n;
    memcpy(state, partial_step->q, n * sizeof *state);
    memcpy(state + n, partial_step->p, n * sizeof *state);
    state[2 * n] = partial_step->t;
}

/* ---- Given times ------------------------------------------------------------------------------------------------- */

/* A time at which a state is wanted, in a rescaled system, whose steps are steps in s. time_from_start is the wanted
 * time minus the time at the start of the last full step. */
typedef struct {
    tvi_partial_step *partial_step;
    double time_from_start;
} time_target;

/* Computes the time on the step's curve at theta minus the wanted time. */
static tvi_status compute_time_beyond_target(void *ctx, double theta, double *g)
{
    const time_target *target = ctx;
    const tvi_integrator *it = target->partial_step->full_step_integrator;
    const tvi_increments *increments = &it->last_step.increments;
    it->stepper->interpolate(it->work, theta, increments->dq, increments->dp);
    *g = increments->dq[it->system->n] - target->time_from_start;
    return isfinite(*g) ? TVI_OK : jet_refuse(TVI_ENONFINITE, "the curve of the step overflows at theta = %g", theta);
}

/* Computes the derivative dt/ds at the end of the last partial step of a rescaled system. */
static tvi_status compute_dt_ds(tvi_partial_step *partial_step, double *dt_ds)
{
    const tvi_integrator *partial = partial_step->partial_step_integrator;
    const size_t n = (size_t)partial->stepped->n;
    memcpy(partial_step->rates_input, partial->state.q, n * sizeof *partial_step->rates_input);
    memcpy(partial_step->rates_input + n, partial->state.p, n * sizeof *partial_step->rates_input);
    partial_step->rates_input[2 * n] = partial->state.q[n];
    const tvi_status status =
        tvi_state_rates_compute(&partial_step->rates_evaluator, partial_step->rates_input, partial_step->rates_output);
    *dt_ds = partial_step->rates_output[partial->system->n];
    return status;
}

/* Computes the state at the given time in a rescaled system. Newton's method finds the offset at which a partial step
 * reaches the time. It starts from `offset`, where the curve of the full step reaches the time. The result is the
 * computed state whose time is nearest. time_from_start is the wanted increment of the time, which is more accurate
 * than the difference of rounded times. */
static tvi_status compute_state_at_time_by_newton(tvi_partial_step *partial_step, double time, double time_from_start,
                                                  double offset)
{
    const tvi_integrator *partial = partial_step->partial_step_integrator;
    const double h = partial_step->full_step_integrator->last_step.h;
    double dt_ds, best = offset, least = INFINITY;
    tvi_status status = TVI_OK;
    for (int count = 0; count < PARTIAL_STEP_MAX_CORRECTIONS && offset != 0 && offset != h; count++) {
        status = tvi_partial_step_compute_state(partial_step, offset);
        if (status != TVI_OK) return status;
        const double rest = time_from_start - partial->last_step.covered_time;
        if (!(fabs(rest) < least)) break;
        best = offset;
        least = fabs(rest);
        if (least <= DBL_EPSILON / 4 * fabs(time)) break;
        status = compute_dt_ds(partial_step, &dt_ds);
        if (status != TVI_OK) return status;
        offset = fmax(fmin(offset + rest / dt_ds, fmax(h, 0)), fmin(h, 0));
    }
    return tvi_partial_step_compute_state(partial_step, least < INFINITY ? best : offset);
}

tvi_status tvi_partial_step_to_time(tvi_partial_step *partial_step, double time)
{
    const tvi_integrator *it = partial_step->full_step_integrator;
    const int n = it->system->n;
    const double h = it->last_step.h,
                 time_from_start = (time - it->last_step.start.q[n]) - it->last_step.start.q_low[n];
    const double offset = fmax(fmin(time_from_start * (h / it->last_step.covered_time), fmax(h, 0)), fmin(h, 0));
    tvi_sign_bracket bracket = {0, -time_from_start, 1, it->last_step.covered_time - time_from_start};
    if (time == it->state.q[n]) return tvi_partial_step_compute_state(partial_step, h);
    /* Without rescaling steps are steps in time, so the offset is the difference of the times. */
    if (!tvi_is_rescaled(it)) return tvi_partial_step_compute_state(partial_step, offset);
    partial_step->full_step_number = 0;
    const tvi_status status = tvi_narrow_bracket(&bracket, DBL_EPSILON / 2, compute_time_beyond_target,
                                                 &(time_target){partial_step, time_from_start});
    return status == TVI_OK ? compute_state_at_time_by_newton(partial_step, time, time_from_start,
                                                              (bracket.g_left == 0 ? bracket.left : bracket.right) * h)
                            : status;
}
