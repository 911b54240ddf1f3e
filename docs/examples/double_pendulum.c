/* double_pendulum.c - a Lagrangian: two equal pendulums, one below the other, which move chaotically.
 *   cc double_pendulum.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Masses and lengths 1, angles q from the vertical:
 *   L = v0^2 + v1^2/2 + v0 v1 cos(q0 - q1) + g (2 cos q0 + cos q1) */
static jet lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    const double *gravity = ctx;
    (void)t;
    const jet mixed = jet_mul(jet_mul(v[0], v[1]), jet_cos(jet_sub(q[0], q[1])));
    const jet kinetic = jet_add(jet_add(jet_sqr(v[0]), jet_mul(0.5, jet_sqr(v[1]))), mixed);
    return jet_add(kinetic, jet_mul(*gravity, jet_add(jet_mul(2, jet_cos(q[0])), jet_cos(q[1]))));
}

int main(void)
{
    double gravity = 9.8, t = 0, q[] = {2, 1}, v[] = {0, 0}, p[2], H0 = 0, H = 0;
    tvi_system *system;
    tvi_integrator *integrator;
    TVI_OR_EXIT(tvi_system_lagrangian(&system, 2, lagrangian, &gravity));
    TVI_OR_EXIT(tvi_momentum(system, t, q, v, p)); /* the state is (q, p): p = L_v */
    TVI_OR_EXIT(tvi_energy(system, t, q, p, &H0));
    TVI_OR_EXIT(tvi_integrator_create(&integrator, system, NULL));
    for (int second = 1; second <= 10; second++) {
        TVI_OR_EXIT(tvi_integrate(integrator, 0.02, 50, &t, q, p, NULL, NULL));
        TVI_OR_EXIT(tvi_velocity(system, t, q, p, v));
        TVI_OR_EXIT(tvi_energy(system, t, q, p, &H));
        printf("%3.0f s: angles %9.4f %9.4f, turning at %9.4f %9.4f, energy error %.0e\n", t, q[0], q[1], v[0], v[1],
               fabs(H - H0));
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
