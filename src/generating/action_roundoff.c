/* action_roundoff.c - estimates the roundoff of the ends of a step by that of the field at the nodes (docs/method.md
 * section 5). */
#include "generating/action.h"

#include <float.h>
#include <math.h>
#include <string.h>

int tvi_action_roundoff(tvi_action *action, const tvi_curve *curve, double h, const double q[], const double p[],
                        double of_q[], double of_p[])
{
    const tvi_system *system = curve->system;
    const double *change = action->roundoff.change;
    const bool separable = system->form == TVI_SEPARABLE;
    const int n = curve->n, points = action->points;
    memset(of_q, 0, (size_t)n * sizeof *of_q);
    memset(of_p, 0, (size_t)n * sizeof *of_p);
    if (!tvi_roundoff_is_motion_small(system, h, q, p, action->x, action->momentum, points, points)) return 0;
    const int values = tvi_roundoff_estimate_of_field(&action->roundoff, system, action->x, points, points);
    for (int i = 0; i < n; i++) {
        const double of_force = fabs(h) * change[i], of_second = separable ? 0 : change[n + i];
        of_p[i] = of_force + DBL_EPSILON * fabs(p[i]);
        if (separable) of_q[i] = fabs(h) / system->mass[i] * of_force;
        else if (system->form == TVI_HAMILTONIAN) of_q[i] = fabs(h) * of_second;
        else of_p[i] += of_second;
    }
    return values;
}
