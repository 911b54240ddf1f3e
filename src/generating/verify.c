/* verify.c - compares a Taylor curve whose step's size was chosen by its coefficients with the force where it ends. */
#include "generating/curve_stepper.h"
#include "generating/curve.h"
#include "method/origin.h"

#include <math.h>

bool tvi_curve_satisfies_force_at_end(tvi_curve_workspace *work, double h, const tvi_step_origin *origin,
                                      const tvi_increments *increments)
{
    const tvi_curve *curve = &work->closure.curve;
    const tvi_system *system = work->closure.system;
    const jet_tape *tape = system->field_values;
    const double t = origin->t + h;
    double most = 0, scale = 0;
    if (!work->field) return true;
    for (int i = 0; i < curve->n; i++) work->field[i] = origin->q[i] + increments->dq[i];
    tvi_system_write_time(system, work->field, 1, &t);
    if (!tape->sweeps->values(tape, work->field, 1)) return false;
    for (int i = 0; i < curve->n; i++) {
        double slope = 0;
        for (int k = work->closure.p_degree; k > 0; k--) slope += k * tvi_curve_momentum_coefficient(curve, k, i);
        work->shift[i] = fabs(h * work->field[tape->output_slot[i]] - slope / curve->kappa[i]);
        most = fmax(most, work->shift[i]);
        scale = fmax(scale, fabs(origin->p[i]) + fabs(increments->dp[i]));
    }
    const double limit = work->q_degree * work->tolerance * scale;
    if (most <= limit || !isfinite(most)) return most <= limit;
    (void)tvi_roundoff_estimate_field(&work->roundoff, system, work->field, 1, 1);
    bool is_roundoff = true;
    for (int i = 0; i < curve->n; i++)
        is_roundoff &= work->shift[i] <= limit + TVI_ROUNDOFF_UNITS * fabs(h) * work->roundoff.field_change[i];
    return is_roundoff;
}
