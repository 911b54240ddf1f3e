/* wing_nut.c - Dzhanibekov's wing nut: a free body that spins about its middle axis turns over, again and again.
 *   cc wing_nut.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi_rigid.h>

#include <tvi_runs.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* The event: the middle axis, whose director is q[6], q[7], q[8], is across the angular momentum. */
static jet middle_axis(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *L = ctx;
    (void)p, (void)t;
    return jet_add(jet_mul(L[0], q[6]), jet_add(jet_mul(L[1], q[7]), jet_mul(L[2], q[8])));
}

/* Called at each event. */
static int say(int event, double t, const double q[], const double p[], void *ctx)
{
    double *last = ctx;
    (void)event, (void)q, (void)p;
    if (*last > 0) printf("turned over in %.6f s\n", t - *last);
    *last = t;
    return 0;
}

int main(void)
{
    const tvi_rigid_body nut = tvi_rigid_box(0.01, 0.02, 0.03, 0.05); /* kg, m: axis 1 is the middle one */
    const tvi_rigid body = {.bodies = 1, .axes = 3, .body = &nut};
    const tvi_rigid_motion motion = {.omega = {1e-3, 10, 1e-3}};
    double t = 0, q[12], p[12], H, end, L[3], L_end[3], last = 0;
    tvi_system *system;
    tvi_integrator *integrator;
    tvi_event *event;
    TVI_OR_EXIT(tvi_rigid_system(&system, &body, NULL, NULL));
    TVI_OR_EXIT(tvi_rigid_state(&body, 0, &motion, q, p));
    TVI_OR_EXIT(tvi_energy(system, t, q, p, &H));
    tvi_rigid_angular_momentum(&body, q, p, L);
    TVI_OR_EXIT(tvi_integrator_create(&integrator, system, NULL));
    TVI_OR_EXIT(tvi_event_create(&event, 12, TVI_EITHER, false, middle_axis, L));
    const tvi_event *const events[] = {event};
    TVI_OR_EXIT(tvi_integrate_events(integrator, 0.05, 400, events, 1, &t, q, p, NULL, say, &last));
    TVI_OR_EXIT(tvi_energy(system, t, q, p, &end));
    tvi_rigid_angular_momentum(&body, q, p, L_end);
    printf("t = %.0f s: energy to %.0e, angular momentum to %.0e\n", t, fabs(end / H - 1),
           hypot(L_end[0] - L[0], hypot(L_end[1] - L[1], L_end[2] - L[2])) / hypot(L[0], hypot(L[1], L[2])));
    tvi_event_free(event);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
