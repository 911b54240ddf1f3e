/* top.c - a heavy top on its point, as a rigid body with a joint: let go at 0.6 rad, it falls, rises and goes round.
 *   cc top.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi_rigid.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Called after each step: how low the axis came. The director of axis 2 is q[9], q[10], q[11]. */
static int watch(long step, double t, const double q[], const double p[], void *ctx)
{
    double *lowest = ctx;
    (void)step, (void)t, (void)p;
    if (q[11] < *lowest) *lowest = q[11];
    return 0;
}

int main(void)
{
    const tvi_rigid_body cone = {.mass = 0.5, .inertia = {2e-4, 2e-4, 1.5e-4}}; /* kg, kg m^2 */
    const tvi_joint point = {.kind = TVI_BALL, .other = TVI_WORLD, .point = {0, 0, -0.04}};
    const tvi_rigid top = {.bodies = 1, .axes = 3, .body = &cone, .joints = 1, .joint = &point, .gravity = {0, 0, -9.8}};
    tvi_rigid_motion motion = {.point = {0, 0, -0.04}, .omega = {0, 0, 200}}; /* 4 cm below the centre of mass, at rest */
    const double sideways[] = {1, 0, 0}, centre[] = {0, 0, 0};
    double t = 0, q[12], p[12], H, end, L[3], L_end[3], x[3], lowest = 1;
    tvi_system *system;
    tvi_integrator *integrator;
    tvi_rigid_turn(sideways, 0.6, motion.quaternion);
    TVI_OR_EXIT(tvi_rigid_system(&system, &top, NULL, NULL));
    TVI_OR_EXIT(tvi_rigid_state(&top, 0, &motion, q, p));
    TVI_OR_EXIT(tvi_energy(system, t, q, p, &H));
    tvi_rigid_angular_momentum(&top, q, p, L);
    TVI_OR_EXIT(tvi_integrator_create(&integrator, system, NULL));
    TVI_OR_EXIT(tvi_integrate(integrator, 0.004, 250, &t, q, p, watch, &lowest));
    TVI_OR_EXIT(tvi_energy(system, t, q, p, &end));
    tvi_rigid_angular_momentum(&top, q, p, L_end);
    TVI_OR_EXIT(tvi_rigid_of(&top, 0, q, p, &motion));
    tvi_rigid_place(&top, q, 0, centre, x);
    printf("t = %.0f s: between %.3f and %.3f rad, the centre at (%.4f, %.4f, %.4f) m\n", t, 0.6, acos(lowest), x[0],
           x[1], x[2]);
    printf("spin %.9f rad/s, the point at %.0e m\n", motion.omega[2],
           hypot(motion.place[0], hypot(motion.place[1], motion.place[2])));
    printf("energy to %.0e, angular momentum about the vertical to %.0e\n", fabs(end / H - 1), fabs(L_end[2] / L[2] - 1));
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
