/* integrate_to.c - a run that ends at a time, by a last shorter step. */
#include "run/between.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>

double tvi_time_left(const tvi_integrator *it, double t_end)
{
    const int n = it->system->n;
    return (t_end - it->now.q[n]) - it->now.q_low[n];
}

/* From a step that went past t_end, which is taken back, to the part of it that ends there. */
static tvi_status shorten(tvi_integrator *it, double t_end, double *t, double q[], double p[])
{
    tvi_between between;
    tvi_status status = tvi_between_open(&between, it, false);
    if (status != TVI_OK) return status;
    status = tvi_between_time(&between, t_end);
    tvi_integrator_take_back(it, t, q, p);
    if (status == TVI_OK) status = tvi_step(it, between.part, t, q, p);
    tvi_between_close(&between);
    return status;
}

void tvi_end_at(tvi_integrator *it, double t_end, double *t)
{
    const int n = it->system->n;
    it->now.q_low[n] += it->now.q[n] - t_end;
    it->now.q[n] = *t = t_end;
}

/* A step of size h, or the last one. Where steps move in the time, its size is the rest of the way. */
static tvi_status step_towards(tvi_integrator *it, double h, double t_end, double *t, double q[], double p[],
                               bool *is_last)
{
    const double roundoff = 2 * DBL_EPSILON * fmax(fabs(t_end), fabs(*t)), rest = tvi_time_left(it, t_end);
    *is_last = !tvi_is_rescaled(it) && fabs(rest) <= fabs(h) + roundoff;
    tvi_status status = tvi_step(it, *is_last ? rest : h, t, q, p);
    if (status != TVI_OK || *is_last) return status;
    const double left = tvi_time_left(it, t_end);
    *is_last = fabs(left) <= roundoff || (left > 0) != (h > 0);
    return fabs(left) > roundoff && *is_last ? shorten(it, t_end, t, q, p) : status;
}

tvi_status tvi_integrate_to(tvi_integrator *it, double h, double t_end, double *t, double q[], double p[],
                            tvi_observer *observer, void *ctx)
{
    if (!it || !t || !q || !p || h == 0 || !isfinite(h) || !isfinite(t_end))
        return tvi_refuse_run((tvi_run_arguments){it, t, q, p, h}, "t_end is not finite");
    if (h > 0 ? t_end < *t : t_end > *t)
        return jet_refuse(TVI_EINVAL, "h = %g does not go from t = %g to t_end = %g", h, *t, t_end);
    tvi_status status = tvi_integrator_begin(it, *t, q, p);
    bool is_last = *t == t_end;
    for (long step = 1; !is_last && status == TVI_OK; step++) {
        status = step_towards(it, h, t_end, t, q, p, &is_last);
        if (status == TVI_OK && is_last) tvi_end_at(it, t_end, t);
        if (status == TVI_OK && observer && observer(step, *t, q, p, ctx) != 0) status = TVI_ESTOPPED;
    }
    return status;
}
