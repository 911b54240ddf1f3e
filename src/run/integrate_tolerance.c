/* integrate_tolerance.c - a run whose steps have the sizes that serve a tolerance. */
#include "run/integrator.h"

#include <float.h>
#include <math.h>

/* A relative tolerance that double precision can serve. */
static bool is_tolerance(double tolerance) { return tolerance >= DBL_EPSILON && tolerance < 1; }

tvi_status tvi_integrate_tolerance(tvi_integrator *it, double tolerance, double t_end, double *t, double q[],
                                   double p[], tvi_observer *observer, void *ctx)
{
    if (!it || !t || !q || !p || !is_tolerance(tolerance) || !isfinite(t_end)) return TVI_EINVAL;
    if (!it->stepper->step_within || it->stepped != it->system) return TVI_EUNSUPPORTED;
    tvi_status status = tvi_integrator_begin(it, *t, q, p);
    bool is_last = *t == t_end;
    for (long step = 1; !is_last && status == TVI_OK; step++) {
        const double rest = tvi_time_left(it, t_end);
        status = tvi_step_within(it, tolerance, rest, t, q, p);
        is_last = status == TVI_OK && (it->h == rest || *t == t_end);
        if (is_last) tvi_end_at(it, t_end, t);
        if (status == TVI_OK && observer && observer(step, *t, q, p, ctx) != 0) status = TVI_ESTOPPED;
    }
    return status;
}
