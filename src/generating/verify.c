/* verify.c - compares a Taylor curve whose step's size was chosen by its coefficients with the force where it ends. */
#include "generating/curve_stepper.h"
#include "generating/curve.h"
#include "method/origin.h"

#include <math.h>

bool tvi_curve_ends_right(tvi_curve_work *w, double h, const tvi_origin *origin, const tvi_increments *increments)
{
    const tvi_curve *curve = &w->closure.curve;
    const tvi_system *system = w->closure.system;
    const jet_tape *tape = system->field_values;
    const double t = origin->t + h;
    double most = 0, scale = 0;
    if (!w->field) return true;
    for (int i = 0; i < curve->n; i++) w->field[i] = origin->q[i] + increments->dq[i];
    tvi_system_write_time(system, w->field, 1, &t);
    if (!tape->sweeps->values(tape, w->field, 1)) return false;
    for (int i = 0; i < curve->n; i++) {
        double slope = 0;
        for (int k = w->closure.p_degree; k > 0; k--) slope += k * tvi_curve_U(curve, k, i);
        w->shift[i] = fabs(h * w->field[tape->output[i]] - slope / curve->kappa[i]);
        most = fmax(most, w->shift[i]);
        scale = fmax(scale, fabs(origin->p[i]) + fabs(increments->dp[i]));
    }
    const double limit = w->q_degree * w->tolerance * scale;
    if (most <= limit || !isfinite(most)) return most <= limit;
    (void)tvi_roundoff_estimate_of_field(&w->roundoff, system, w->field, 1, 1);
    bool is_roundoff = true;
    for (int i = 0; i < curve->n; i++)
        is_roundoff &= w->shift[i] <= limit + TVI_ROUNDOFF_UNITS * fabs(h) * w->roundoff.change[i];
    return is_roundoff;
}
