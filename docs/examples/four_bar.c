/* four_bar.c - a crank, a rocker and the rod between their ends, as two masses on three constraints.
 *   cc four_bar.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { CRANK, ROCKER, COUPLER, RODS };
static const double length[RODS] = {1, 1.5, 2}, pivot[] = {2.2, 0}, mass[] = {1, 1, 2, 2}, g = 9.8;

/* The ends of the crank and of the rocker are (q0, q1) and (q2, q3). */
static jet weight(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_mul(mass[0] * g, q[1]), jet_mul(mass[2] * g, q[3]));
}

/* (d.d - l^2) / 2 of each rod */
static void rods(const jet q[], jet t, jet value[], void *ctx)
{
    const jet d[RODS][2] = {
        {q[0], q[1]}, {jet_sub(q[2], pivot[0]), jet_sub(q[3], pivot[1])}, {jet_sub(q[2], q[0]), jet_sub(q[3], q[1])}};
    (void)t, (void)ctx;
    for (int k = 0; k < RODS; k++) value[k] = jet_mul(0.5, jet_sub(jet_dot(d[k], d[k], 2), length[k] * length[k]));
}

static int watch(long step, double t, const double q[], const double p[], void *ctx)
{
    double lambda[RODS];
    TVI_OR_EXIT(tvi_multipliers(ctx, t, q, p, lambda, NULL));
    (void)step; /* lambda times the length is the tension: above 0 a rod pulls, below 0 it pushes */
    return printf("%.0f s: crank at %7.4f rad, tension of the coupler %9.4f\n", t, atan2(q[1], q[0]),
                  lambda[COUPLER] * length[COUPLER]) < 0;
}

int main(void)
{
    tvi_system *masses, *linkage;
    tvi_integrator *integrator;
    double t = 0, q[] = {0, 1, 2, 1.5}, p[] = {3, 0, 0, 0}, value[RODS], rate[RODS], before, after, worst = 0;
    const double times[] = {1, 2, 3, 4, 5, 6};
    TVI_OR_EXIT(tvi_system_potential(&masses, 4, mass, weight, NULL));
    TVI_OR_EXIT(tvi_system_constrained(&linkage, masses, RODS, rods, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&integrator, linkage, NULL));
    TVI_OR_EXIT(tvi_project(linkage, t, q, p)); /* the start is only a sketch */
    TVI_OR_EXIT(tvi_energy(linkage, t, q, p, &before));
    TVI_OR_EXIT(tvi_integrate_at(integrator, 0.02, times, 6, &t, q, p, watch, linkage));
    TVI_OR_EXIT(tvi_energy(linkage, t, q, p, &after));
    TVI_OR_EXIT(tvi_constraint_values(linkage, t, q, p, value, rate));
    for (int k = 0; k < RODS; k++) worst = fmax(worst, fmax(fabs(value[k]), fabs(rate[k])));
    printf("energy error %.0e, constraints kept to %.0e\n", fabs(after / before - 1), worst);
    tvi_integrator_free(integrator);
    tvi_system_free(linkage);
    tvi_system_free(masses);
}
