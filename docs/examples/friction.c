/* friction.c - a pendulum with friction and a drive: it forgets its start, and swings with the drive in the end.
 *   cc friction.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>

static const double OMEGA = 2.0 / 3;

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_cos(q[0]));
}

/* What is added to dp/dt: -v/2 + 0.9 cos(2 t / 3). */
static void drive(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)ctx;
    force[0] = jet_sub(jet_mul(0.9, jet_cos(jet_mul(OMEGA, t))), jet_div(v[0], 2));
}

int main(void)
{
    tvi_system *pendulum, *driven = NULL;
    tvi_integrator *integrator = NULL;
    tvi_status status = tvi_system_potential(&pendulum, 1, NULL, potential, NULL);
    if (status == TVI_OK) status = tvi_system_driven(&driven, pendulum, drive, NULL);
    if (status == TVI_OK) status = tvi_integrator_create(&integrator, driven, NULL);
    const double period = 2 * acos(-1) / OMEGA, starts[] = {0.1, 2};
    for (int i = 0; i < 2 && status == TVI_OK; i++) {
        double t = 0, q = starts[i], p = 0;
        status = tvi_integrate(integrator, period / 40, 40 * 40, &t, &q, &p, NULL, NULL);
        if (status == TVI_OK) printf("from %.1f, after 40 periods: q = %.9f, p = %.9f\n", starts[i], q, p);
    }
    if (status != TVI_OK) fprintf(stderr, "%s\n", tvi_last_error());
    tvi_integrator_free(integrator);
    tvi_system_free(driven);
    tvi_system_free(pendulum);
    return status != TVI_OK;
}
