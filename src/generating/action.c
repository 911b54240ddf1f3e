/* action.c - the gradient of the discrete action, as seeds for the gradient of the curve: those of seeds.h, and of
 * terms that are found by passes or from second derivatives. */
#include "generating/action.h"
#include "algebra/passes.h"
#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { NEWTON_STEPS = 50 };
/* Corrections of the momenta that no longer shrink are roundoff: below this part of the largest momentum, or below this
 * many units of what the roundoff of H_p and v makes of them. */
static const double STALLED = 1e-13;

/* The roundoff of the corrections, by that of the H_p that was last evaluated. */
static double measure_roundoff(tvi_action *action, const tvi_curve *curve)
{
    const int n = curve->n, points = action->points;
    tvi_roundoff *roundoff = &action->roundoff;
    (void)tvi_roundoff_of_field(roundoff, curve->system, action->x, points, points);
    for (int i = 0; i < n; i++) {
        const double of_v = DBL_EPSILON * tvi_largest(points, action->on_v + i * points, 1);
        action->correction[i] = tvi_roundoff_sign(roundoff, roundoff->change[n + i] + of_v);
    }
    tvi_factor_solve(&curve->slope, action->correction);
    return TVI_ROUNDOFF_UNITS * tvi_largest(n, action->correction, 1);
}

/* Momenta with H_p(q_i, p_i) = v_i at all nodes, from those of the curve, by a Newton method with H_pp at the centre. v
 * is in action->on_v; the momenta are left in the second input. */
static tvi_status solve_node_momenta(tvi_action *action, tvi_curve *curve)
{
    const jet_tape *tape = curve->system->field_values;
    const int n = curve->n, points = action->points;
    double *p = action->x + n * points;
    tvi_passes passes = TVI_NO_PASSES;
    memcpy(p, action->momentum, (size_t)(n * points) * sizeof *p);
    const double size = tvi_largest(n * points, p, 1);
    const tvi_passes_rule rule = {.goal = DBL_EPSILON * size, .stuck = TVI_PASSES_ALL, .roundoff = STALLED * size};
    tvi_status status = tvi_curve_factor_slope(curve);
    for (int step = 0; step < NEWTON_STEPS && status == TVI_OK; step++) {
        status = seeds_run_field(action, curve);
        double largest = 0;
        for (int node = 0; node < points && status == TVI_OK; node++) {
            for (int i = 0; i < n; i++)
                action->correction[i] =
                    action->on_v[i * points + node] - seeds_output_row(action, tape, action->x, n + i)[node];
            tvi_factor_solve(&curve->slope, action->correction);
            for (int i = 0; i < n; i++) {
                p[i * points + node] += action->correction[i];
                largest = fmax(largest, fabs(action->correction[i]));
            }
        }
        if (!isfinite(largest)) return TVI_ENONFINITE;
        const tvi_passes_verdict verdict = tvi_passes_judge(&passes, &rule, largest);
        if (verdict == TVI_PASSES_MAY_END ||
            (verdict == TVI_PASSES_STUCK && tvi_passes_are_roundoff(&passes, measure_roundoff(action, curve))))
            return seeds_run_field(action, curve);
    }
    return status == TVI_OK ? TVI_ENOCONV : status;
}

/* From the positions in action->x, the velocities in on_v and the momenta: on_q = tau L_q, on_v = L_v - p. */
static tvi_status lagrange_terms(tvi_action *action, tvi_curve *curve)
{
    const tvi_system *system = curve->system;
    const int n = curve->n, points = action->points;
    const size_t panel = (size_t)(n * points) * sizeof(double);
    double *second = action->x + n * points;
    tvi_status status = TVI_OK;
    switch (system->form) {
    case TVI_SEPARABLE:
        status = seeds_run_field(action, curve);
        seeds_copy_outputs(action, curve, 0, curve->tau, action->on_q);
        for (int i = 0; i < n * points; i++) action->on_v[i] *= system->mass[i / points];
        break;
    case TVI_LAGRANGIAN:
        memcpy(second, action->on_v, panel);
        status = seeds_run_field(action, curve);
        seeds_copy_outputs(action, curve, 0, curve->tau, action->on_q);
        seeds_copy_outputs(action, curve, n, 1, action->on_v);
        break;
    case TVI_HAMILTONIAN:
        status = solve_node_momenta(action, curve);
        seeds_copy_outputs(action, curve, 0, -curve->tau, action->on_q);
        memcpy(action->on_v, second, panel);
        break;
    }
    seeds_subtract(action, n, action->momentum, action->on_v);
    return status;
}

tvi_status tvi_action_lagrange(tvi_action *action, tvi_curve *curve, const double q[], const double v[],
                               const double p[])
{
    const size_t panel = (size_t)(curve->n * action->points) * sizeof *q;
    memcpy(action->x, q, panel);
    memcpy(action->on_v, v, panel);
    memcpy(action->momentum, p, panel);
    seeds_place_times(action, curve, action->x);
    return lagrange_terms(action, curve);
}

/* Truncated, q'_i = H_p(q_i, p_i): on_q = tau (H_qp p - H_q), on_p = tau H_pp p, on_v = -p. */
static tvi_status bent_terms(tvi_action *action, const tvi_curve *curve)
{
    const tvi_system *system = curve->system;
    const int n = curve->n, points = action->points;
    const size_t panel = (size_t)(n * points) * sizeof(double);
    const bool separable = system->form == TVI_SEPARABLE;
    if (!separable) memcpy(action->x + n * points, action->momentum, panel);
    const tvi_status status = seeds_run_field(action, curve);
    if (status != TVI_OK) return status;
    seeds_copy_outputs(action, curve, 0, separable ? curve->tau : -curve->tau, action->on_q);
    if (!separable) {
        memcpy(action->bend, action->x, (size_t)(2 * n + system->uses_time) * (size_t)points * sizeof(double));
        memcpy(action->bend + (2 * n + 1) * points, action->momentum, panel);
        if (!jet_sweep_values(system->bend_values, action->bend, points)) return TVI_EDOMAIN;
    }
    for (int i = 0; i < n; i++)
        for (int node = 0; node < points; node++) {
            const int place = i * points + node;
            if (separable) {
                action->on_p[place] = curve->tau * action->momentum[place] / system->mass[i];
            } else {
                action->on_q[place] +=
                    curve->tau * seeds_output_row(action, system->bend_values, action->bend, i)[node];
                action->on_p[place] =
                    curve->tau * seeds_output_row(action, system->bend_values, action->bend, n + i)[node];
            }
            action->on_v[place] = -action->momentum[place];
        }
    return TVI_OK;
}

/* ---- The seeds --------------------------------------------------------------------------------------------------- */

static tvi_seeds_fn *const plainly_of[JET_ISA_COUNT] = {
    [jet_isa_base] = tvi_seeds_plainly_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = tvi_seeds_plainly_avx2,
    [jet_isa_avx512] = tvi_seeds_plainly_avx512,
#endif
};

static tvi_status seed(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[])
{
    if (seeds_are_plain(action)) {
        if (!curve->code || !curve->code->seed) return plainly_of[action->sweeps->isa](action, curve, seed_Q, seed_U);
        const tvi_status status = curve->code->seed(action, curve, seed_Q, seed_U);
        if (status == TVI_EDOMAIN) (void)jet_refuse_sweep(curve->system->field_values, action->x, action->points);
        return status;
    }
    seeds_begin(action, curve, seed_Q, seed_U);
    if (action->has_velocity_defect) seeds_place_velocities(action, curve, action->on_v);
    const tvi_status status = action->is_hamilton ? bent_terms(action, curve) : lagrange_terms(action, curve);
    if (status == TVI_OK) seeds_end(action, curve, seed_Q, seed_U);
    return status;
}

tvi_status tvi_action_seed(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[])
{
    const int seeds = (curve->top + 1) * curve->n;
    const bool has_U = curve->system->form != TVI_SEPARABLE;
    const tvi_status status = seed(action, curve, seed_Q, seed_U);
    if (status != TVI_OK) return status;
    return tvi_all_finite(seeds, seed_Q) && (!has_U || tvi_all_finite(seeds, seed_U)) ? TVI_OK : TVI_ENONFINITE;
}
