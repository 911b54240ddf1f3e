/* action_roundoff.c - how well the ends of a step are known, by the field at the nodes (docs/method.md section 5). */
#include "generating/action.h"
#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Whether rows of values at the nodes are no farther from the start than this is from the origin. */
static bool is_near(const tvi_action *action, int n, const double start[], const double *rows)
{
    const double size = tvi_largest(n, start, 1);
    for (int i = 0; i < n; i++)
        for (int node = 0; node < action->points; node++)
            if (!(fabs(rows[i * action->points + node] - start[i]) <= size)) return false;
    return true;
}

/* In a motion larger than that, roundoff has no other size than the motion; and passes that run off, to where the field
 * is nothing but roundoff, have not arrived. */
int tvi_action_roundoff(tvi_action *action, const tvi_curve *curve, double h, const double q[], const double p[],
                        double of_q[], double of_p[])
{
    const tvi_system *system = curve->system;
    const double *change = action->roundoff.change;
    const bool separable = system->form == TVI_SEPARABLE;
    const int n = curve->n;
    memset(of_q, 0, (size_t)n * sizeof *of_q);
    memset(of_p, 0, (size_t)n * sizeof *of_p);
    if (!is_near(action, n, q, action->x) && (separable || !is_near(action, n, p, action->momentum))) return 0;
    const int runs = tvi_roundoff_of_field(&action->roundoff, system, system->field_values, action->x, action->points);
    for (int i = 0; i < n; i++) {
        const double of_force = fabs(h) * change[i], of_second = separable ? 0 : change[n + i];
        of_p[i] = of_force + DBL_EPSILON * fabs(p[i]);
        if (separable) of_q[i] = fabs(h) / system->mass[i] * of_force;
        else if (system->form == TVI_HAMILTONIAN) of_q[i] = fabs(h) * of_second;
        else of_p[i] += of_second;
    }
    return runs * action->points;
}
