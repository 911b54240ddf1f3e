/* inside_step.c - Computes states inside the last step, on its curve, or by a shorter step of the method
 * (inside_step.h). */
#include "integrator/inside_step.h"
#include "algebra/narrow.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* [corrections] The size of a partial step is corrected at most this often. */
#define PARTIAL_STEP_MAX_CORRECTIONS 12 /* found: make check-events */
/* [h] Partial steps whose sizes differ by less have nearly the same nodes and can use each other's history. */
#define PARTIAL_STEP_NEAR 1e-3 /* found: make check-events */

void tvi_run_state_to_vector(const tvi_run_state *from, int n, double state[])
{
    memcpy(state, from->q, (size_t)n * sizeof *state);
    memcpy(state + n, from->p, (size_t)n * sizeof *state);
    state[2 * n] = from->q[n];
}

/* ---- On the curve ------------------------------------------------------------------------------------------------ */

const double tvi_sample_theta[TVI_SAMPLES] = {0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1};

/* Sets last_step.increments to the changes of the coordinates and momenta on the curve, from the start of the step to
 * theta. Returns the time there. */
static double follow_curve(tvi_integrator *it, double theta)
{
    const int n = it->system->n;
    const tvi_increments *increments = &it->last_step.increments;
    it->stepper->interpolate(it->work, theta, increments->dq, increments->dp);
    increments->dq[it->stepped->n] = theta * it->last_step.h;
    return it->last_step.start.q[n] + (it->last_step.start.q_low[n] + increments->dq[n]);
}

tvi_status tvi_evaluate_dense_output(tvi_integrator *it, double theta, double *t, double q[], double p[])
{
    const int n = it->system->n;
    const tvi_increments *increments = &it->last_step.increments;
    if (theta == 1) { /* The state at the end of the step is known more accurately than the curve. */
        tvi_integrator_copy_state(it, t, q, p);
        return TVI_OK;
    }
    const double time = follow_curve(it, theta);
    for (int i = 0; i < n; i++) {
        increments->dq[i] += it->last_step.start.q[i];
        increments->dp[i] += it->last_step.start.p[i];
    }
    if (!tvi_all_finite(n, increments->dq) || !tvi_all_finite(n, increments->dp))
        return jet_refuse(TVI_ENONFINITE, "the curve of the step overflows at theta = %g", theta);
    memcpy(q, increments->dq, (size_t)n * sizeof *q);
    memcpy(p, increments->dp, (size_t)n * sizeof *p);
    *t = time;
    return TVI_OK;
}

tvi_status tvi_dense(tvi_integrator *it, double theta, double q[], double p[])
{
    double t;
    if (!it || !q || !p) return tvi_refuse_invalid_run_arguments((tvi_run_arguments){it, &t, q, p, 1}, "");
    if (!(theta >= 0 && theta <= 1)) return jet_refuse(TVI_EINVAL, "theta = %g is not in [0, 1]", theta);
    if (!it->last_step.has_curve) return jet_refuse(TVI_EINVAL, "there is no last step, or it failed");
    return tvi_evaluate_dense_output(it, theta, &t, q, p);
}

/* Computes the states at all sample points by one call of the stepper's `interpolate` for each point. Steppers without
 * the function `sample` need this. */
static void interpolate_at_all_sample_points(tvi_integrator *it, double *q, double *p, double *t)
{
    const int n = it->system->n;
    for (int k = 0; k < TVI_SAMPLES; k++) {
        t[k] = follow_curve(it, tvi_sample_theta[k]);
        for (int i = 0; i < n; i++) {
            q[i * TVI_SAMPLES + k] = it->last_step.start.q[i] + it->last_step.increments.dq[i];
            p[i * TVI_SAMPLES + k] = it->last_step.start.p[i] + it->last_step.increments.dp[i];
        }
    }
}

void tvi_sample_dense_output(tvi_integrator *it, const tvi_component_range used_components[2], double *samples)
{
    const int n = it->system->n, end = TVI_SAMPLES - 1;
    double *q = samples, *p = q + n * TVI_SAMPLES, *t = p + n * TVI_SAMPLES;
    if (it->stepper->sample && !tvi_is_rescaled(it)) {
        it->stepper->sample(it->work, used_components, it->last_step.start.q, it->last_step.start.p, q, p);
        for (int k = 0; k < end; k++)
            t[k] = it->last_step.start.q[n] + (it->last_step.start.q_low[n] + tvi_sample_theta[k] * it->last_step.h);
    } else {
        interpolate_at_all_sample_points(it, q, p, t);
    }
    for (int i = used_components[0].first; i < used_components[0].end; i++) q[i * TVI_SAMPLES + end] = it->state.q[i];
    for (int i = used_components[1].first; i < used_components[1].end; i++) p[i * TVI_SAMPLES + end] = it->state.p[i];
    t[end] = it->state.q[n];
}

/* ---- By a shorter step ------------------------------------------------------------------------------------------- */

tvi_status tvi_partial_step_open(tvi_partial_step *partial_step, tvi_integrator *full_step_integrator,
                                 bool uses_history_after_step)
{
    *partial_step = (tvi_partial_step){.full_step_integrator = full_step_integrator,
                                       .uses_history_after_step = uses_history_after_step,
                                       .copied_parameter_version = full_step_integrator->parameter_version};
    partial_step->state = calloc(2 * (size_t)full_step_integrator->system->n + 1, sizeof *partial_step->state);
    if (!partial_step->state) return jet_explain_out_of_memory(TVI_ENOMEM);
    const tvi_status status = tvi_integrator_create_like(&partial_step->partial_step_integrator, full_step_integrator);
    if (status != TVI_OK) tvi_partial_step_close(partial_step);
    return jet_explain_out_of_memory(status);
}

void tvi_partial_step_close(tvi_partial_step *partial_step)
{
    tvi_integrator_free(partial_step->partial_step_integrator);
    free(partial_step->state);
    *partial_step = (tvi_partial_step){0};
}

tvi_status tvi_partial_step_set_parameters(tvi_partial_step *partial_step)
{
    const tvi_integrator *it = partial_step->full_step_integrator;
    if (partial_step->copied_parameter_version == it->parameter_version) return TVI_OK;
    partial_step->copied_parameter_version = it->parameter_version;
    partial_step->full_step_number = 0;
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
    const int n = it->system->n;
    const bool is_end = offset == it->last_step.h;
    double *q = partial_step->state, *p = q + n, *t = p + n;
    if (partial_step->full_step_number == it->stats.steps && partial_step->stored_state_offset == offset) return TVI_OK;
    tvi_run_state_to_vector(is_end ? &it->state : &it->last_step.start, n, partial_step->state);
    if (!is_end && offset != 0) {
        set_partial_step_history(partial_step, offset);
        partial_step->full_step_number = 0;
        const tvi_status status = tvi_step(partial_step->partial_step_integrator, offset, t, q, p);
        if (status != TVI_OK) return status;
    }
    partial_step->full_step_number = it->stats.steps;
    partial_step->stored_state_offset = offset;
    return TVI_OK;
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
    tvi_integrator *it = target->partial_step->full_step_integrator;
    const tvi_increments *increments = &it->last_step.increments;
    (void)follow_curve(it, theta);
    *g = increments->dq[it->system->n] - target->time_from_start;
    return isfinite(*g) ? TVI_OK : jet_refuse(TVI_ENONFINITE, "the curve of the step overflows at theta = %g", theta);
}

/* Computes the derivative dt/ds, a component of the field, at the end of the last partial step of a rescaled system. */
static tvi_status compute_dt_ds(tvi_integrator *partial, double *dt_ds)
{
    const int rate_of_t = partial->stepped->n + partial->system->n;
    if (!tvi_integrator_compute_field(partial, partial->state.q, partial->state.p)) return TVI_EDOMAIN;
    *dt_ds = partial->guard.field_block[partial->stepped->field_values->output_slot[rate_of_t]];
    return TVI_OK;
}

/* Computes the state at the given time in a rescaled system. Newton's method finds the offset at which a partial step
 * reaches the time. It starts from `offset`, where the curve of the full step reaches the time. The result is the
 * computed state whose time is nearest. time_from_start is the wanted increment of the time, which is more accurate
 * than the difference of rounded times. */
static tvi_status compute_state_at_time_by_newton(tvi_partial_step *partial_step, double time, double time_from_start,
                                                  double offset)
{
    tvi_integrator *partial = partial_step->partial_step_integrator;
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
        status = compute_dt_ds(partial, &dt_ds);
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
