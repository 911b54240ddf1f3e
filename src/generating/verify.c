/* verify.c - checks whether a Taylor curve satisfies dp/ds = h F at its end, for steps whose size was chosen from the
 * coefficients. curve_stepper.c calls it. */
#include "generating/curve_stepper.h"
#include "generating/curve.h"
#include "method/origin.h"

#include <math.h>

bool tvi_curve_matches_force_at_end(tvi_curve_workspace *work, double relative_tolerance, double h,
                                    const tvi_step_origin *origin, const tvi_increments *increments)
{
    const tvi_curve *curve = &work->closure.curve;
    const tvi_system *system = work->closure.system;
    const jet_tape *tape = system->field_values;
    const double t = origin->t + h;
    double largest_defect = 0, largest_momentum = 0;
    if (!work->end_field_block) return true;
    for (int i = 0; i < curve->n; i++) work->end_field_block[i] = origin->q[i] + increments->dq[i];
    tvi_system_write_time(system, work->end_field_block, 1, &t);
    if (!tape->sweeps->values(tape, work->end_field_block, 1)) return false;
    for (int i = 0; i < curve->n; i++) {
        double slope = 0;
        for (int k = work->closure.p_degree; k > 0; k--) slope += k * tvi_curve_momentum_coefficient(curve, k, i);
        work->scratch[i] = fabs(h * work->end_field_block[tape->output_slot[i]] - slope / curve->kappa[i]);
        largest_defect = fmax(largest_defect, work->scratch[i]);
        largest_momentum = fmax(largest_momentum, fabs(origin->p[i]) + fabs(increments->dp[i]));
    }
    const double limit = work->q_degree * relative_tolerance * largest_momentum;
    if (largest_defect <= limit || !isfinite(largest_defect)) return largest_defect <= limit;
    (void)tvi_roundoff_estimate_field(&work->end_field_roundoff, system, work->end_field_block, 1, 1);
    bool is_roundoff = true;
    for (int i = 0; i < curve->n; i++)
        is_roundoff &=
            work->scratch[i] <= limit + ROUNDOFF_MAX_UNITS * fabs(h) * work->end_field_roundoff.output_roundoff[i];
    return is_roundoff;
}
