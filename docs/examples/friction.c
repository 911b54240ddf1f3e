/* friction.c - a pendulum with friction and a drive: it forgets its start, and swings with the drive in the end.
 *   cc friction.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double OMEGA = 2.0 / 3;

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_cos(q[0]));
}

/* The force that is added to dp/dt: -v/2 + 0.9 cos(2 t / 3). */
static void drive(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)ctx;
    force[0] = jet_sub(jet_mul(0.9, jet_cos(jet_mul(OMEGA, t))), jet_div(v[0], 2));
}

int main(void)
{
    tvi_system *pendulum, *driven;
    tvi_integrator *integrator;
    TVI_OR_EXIT(tvi_system_potential(&pendulum, 1, NULL, potential, NULL));
    TVI_OR_EXIT(tvi_system_driven(&driven, pendulum, drive, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&integrator, driven, NULL));
    const double period = 2 * acos(-1) / OMEGA, starts[] = {0.1, 2};
    for (int i = 0; i < 2; i++) {
        double t = 0, q = starts[i], p = 0;
        TVI_OR_EXIT(tvi_integrate(integrator, period / 40, 40 * 40, &t, &q, &p, NULL, NULL));
        printf("from %.1f, after 40 periods: q = %.9f, p = %.9f\n", starts[i], q, p);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(driven);
    tvi_system_free(pendulum);
}
