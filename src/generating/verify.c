/* verify.c - checks whether a Taylor curve satisfies dp/ds = h F at its end, for steps whose size was chosen from the
 * coefficients. curve_stepper.c calls it. */
#include "generating/curve_stepper.h"
#include "algebra/sizes.h"
#include "generating/curve.h"
#include "method/origin.h"

#include <math.h>

bool tvi_curve_matches_force_at_end(tvi_curve_workspace *work, double relative_tolerance, double h,
                                    const tvi_step_origin *origin, const tvi_increments *increments)
{
    const tvi_curve *curve = &work->corrected_curve.curve;
    const tvi_system *system = work->corrected_curve.system;
    const jet_tape *tape = system->field_values;
    const double t = origin->t + h;
    double largest_defect = 0, largest_momentum = TVI_LEAST_SIZE;
    if (!work->field_tape_values_at_step_end) return true;
    for (int i = 0; i < curve->n; i++) work->field_tape_values_at_step_end[i] = origin->q[i] + increments->dq[i];
    tvi_system_write_time(system, work->field_tape_values_at_step_end, 1, &t);
    if (!tape->sweeps->values(tape, work->field_tape_values_at_step_end, 1)) return false;
    for (int i = 0; i < curve->n; i++) {
        double slope = 0;
        for (int k = work->corrected_curve.p_degree; k > 0; k--)
            slope += k * tvi_curve_momentum_coefficient(curve, k, i);
        work->scratch[i] = fabs(h * work->field_tape_values_at_step_end[tape->output_slot[i]] -
                                slope / curve->momentum_scale_factor[i]);
        largest_defect = fmax(largest_defect, work->scratch[i]);
        largest_momentum = fmax(largest_momentum, fabs(origin->p[i]) + fabs(increments->dp[i]));
    }
    const double limit = work->q_degree * relative_tolerance * largest_momentum;
    if (largest_defect <= limit || !isfinite(largest_defect)) return largest_defect <= limit;
    (void)tvi_roundoff_estimate_field(&work->end_field_roundoff, system, work->field_tape_values_at_step_end, 1, 1);
    bool is_roundoff = true;
    for (int i = 0; i < curve->n; i++)
        is_roundoff &=
            work->scratch[i] <= limit + ROUNDOFF_MAX_UNITS * fabs(h) * work->end_field_roundoff.output_roundoff[i];
    return is_roundoff;
}
