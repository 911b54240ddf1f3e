/* A program that rounds down (fesetround) makes steps of an oscillator: events are found, and a step of taylor is
 * refused with "its passes overflow: the step is too large", which it is not. Right: cos t to 1e-10, or a refusal
 * whose text speaks of the rounding. */
#include <fenv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <tvi.h>
#include "verdict.h"

static jet V(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_sqr(q[0]));
}

static jet g(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return q[0];
}

static void end(const char *name, tvi_status status, double t, double q)
{
    const bool is_right = status == TVI_OK ? fabs(q - cos(t)) < 1e-10 : strstr(tvi_last_error(), "round") != NULL;
    row(is_right, "%s: %d at t = %g, q = %g %s", name, status, t, q, status ? tvi_last_error() : "");
}

int main(void)
{
    tvi_system *system;
    tvi_integrator *it;
    tvi_event *event;
    tvi_options options;
    double t = 0, q = 1, p = 0;
    TVI_OR_EXIT(tvi_system_potential(&system, 1, NULL, V, NULL));
    TVI_OR_EXIT(tvi_event_create(&event, 1, TVI_EITHER, false, g, NULL));
    TVI_OR_EXIT(tvi_options_named("taylor", 8, &options));
    fesetround(FE_DOWNWARD);
    TVI_OR_EXIT(tvi_integrator_create(&it, system, NULL));
    const tvi_event *const events[] = {event};
    const tvi_status status = tvi_integrate_events(it, 0.1, 3, events, 1, &t, &q, &p, NULL, NULL, NULL);
    end("events", status, t, q);
    tvi_integrator_free(it);
    TVI_OR_EXIT(tvi_integrator_create(&it, system, &options));
    end("taylor", tvi_step(it, 0.1, &t, &q, &p), t, q);
    tvi_integrator_free(it), tvi_event_free(event), tvi_system_free(system);
    return verdict();
}
