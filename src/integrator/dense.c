/* dense.c - Evaluates the curve of the last step (tvi_dense) at one point of the step, or at all points where the
 * search for events samples it. theta is the part of the step, from 0 at its start to 1 at its end. */
#include "integrator/integrator.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <string.h>

tvi_status tvi_evaluate_dense_output(tvi_integrator *it, double theta, double *t, double q[], double p[])
{
    const int n = it->system->n;
    if (theta == 1) { /* The state at the end of the step is known more accurately than the curve. */
        tvi_integrator_copy_state(it, t, q, p);
        return TVI_OK;
    }
    it->stepper->interpolate(it->work, theta, it->last_step.increments.dq, it->last_step.increments.dp);
    it->last_step.increments.dq[it->stepped->n] = theta * it->last_step.h;
    for (int i = 0; i < n; i++) {
        it->last_step.increments.dq[i] += it->last_step.start.q[i];
        it->last_step.increments.dp[i] += it->last_step.start.p[i];
    }
    if (!tvi_all_finite(n, it->last_step.increments.dq) || !tvi_all_finite(n, it->last_step.increments.dp))
        return jet_refuse(TVI_ENONFINITE, "the curve of the step overflows at theta = %g", theta);
    memcpy(q, it->last_step.increments.dq, (size_t)n * sizeof *q);
    memcpy(p, it->last_step.increments.dp, (size_t)n * sizeof *p);
    *t = it->last_step.start.q[n] + (it->last_step.start.q_low[n] + it->last_step.increments.dq[n]);
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

/* ---- Samples ----------------------------------------------------------------------------------------------------- */

const double tvi_sample_theta[TVI_SAMPLES] = {0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1};

/* Computes the states at all sample points by one call of the stepper's `interpolate` for each point. Steppers without
 * the function `sample` need this. */
static void interpolate_at_all_sample_points(tvi_integrator *it, double *q, double *p, double *t)
{
    const int n = it->system->n;
    for (int k = 0; k < TVI_SAMPLES; k++) {
        it->stepper->interpolate(it->work, tvi_sample_theta[k], it->last_step.increments.dq,
                                 it->last_step.increments.dp);
        it->last_step.increments.dq[it->stepped->n] = tvi_sample_theta[k] * it->last_step.h;
        for (int i = 0; i < n; i++) {
            q[i * TVI_SAMPLES + k] = it->last_step.start.q[i] + it->last_step.increments.dq[i];
            p[i * TVI_SAMPLES + k] = it->last_step.start.p[i] + it->last_step.increments.dp[i];
        }
        t[k] = it->last_step.start.q[n] + (it->last_step.start.q_low[n] + it->last_step.increments.dq[n]);
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
