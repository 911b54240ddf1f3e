/* action_roundoff.c - estimates the roundoff of q and p at the ends of a step from the roundoff of the field at the
 * nodes (docs/method.md section 5). curve_stepper.c and both_ends.c call it when passes no longer converge. */
#include "generating/action.h"

#include <float.h>
#include <math.h>
#include <string.h>

int tvi_estimate_end_roundoff(tvi_action *action, const tvi_curve *curve, double h, const double q[], const double p[],
                              double q_roundoff[], double p_roundoff[])
{
    const tvi_system *system = curve->system;
    const double *change = action->field_roundoff.field_change;
    const bool separable = system->form == TVI_SEPARABLE;
    const int n = curve->n, points = action->points;
    memset(q_roundoff, 0, (size_t)n * sizeof *q_roundoff);
    memset(p_roundoff, 0, (size_t)n * sizeof *p_roundoff);
    if (!tvi_roundoff_is_motion_small(system, h, q, p, action->field_block, action->node_momentum, points, points))
        return 0;
    const int values =
        tvi_roundoff_estimate_field(&action->field_roundoff, system, action->field_block, points, points);
    for (int i = 0; i < n; i++) {
        const double of_force = fabs(h) * change[i], of_second = separable ? 0 : change[n + i];
        p_roundoff[i] = of_force + DBL_EPSILON * fabs(p[i]);
        if (separable) q_roundoff[i] = fabs(h) / system->mass[i] * of_force;
        else if (system->form == TVI_HAMILTONIAN) q_roundoff[i] = fabs(h) * of_second;
        else p_roundoff[i] += of_second;
    }
    return values;
}
