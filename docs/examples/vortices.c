/* vortices.c - a Hamiltonian without masses: three point vortices in the plane; no Lagrangian exists.
 *   cc vortices.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Vortices of circulation 1 at (q_i, p_i): H = -sum_{i<j} log(|x_i - x_j|^2) / (4 pi), Kirchhoff's equations. */
enum { N = 3 };

static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet H = jet_const(0);
    for (int i = 1; i < N; i++)
        for (int j = 0; j < i; j++) {
            const jet x = jet_sub(q[i], q[j]), y = jet_sub(p[i], p[j]);
            const jet distance2 = jet_add(jet_sqr(x), jet_sqr(y));
            H = jet_sub(H, jet_div(jet_log(distance2), 16 * atan(1)));
        }
    return H;
}

int main(void)
{
    double t = 0, q[N] = {1, -0.5, -0.5}, p[N] = {0, 0.75, -0.75};
    double H0 = 0, H = 0;
    tvi_system *system;
    tvi_integrator *it;
    TVI_OR_EXIT(
        tvi_system_hamiltonian(&system, N, hamiltonian, NULL));
    TVI_OR_EXIT(tvi_energy(system, t, q, p, &H0));
    TVI_OR_EXIT(tvi_integrator_create(&it, system, NULL));
    TVI_OR_EXIT(tvi_integrate(it, 0.5, 2000, &t, q, p, NULL, NULL));
    TVI_OR_EXIT(tvi_energy(system, t, q, p, &H));
    /* the centre is kept, and the spread about it */
    double x = 0, y = 0, spread = 0;
    for (int i = 0; i < N; i++) {
        x += q[i], y += p[i];
        spread += q[i] * q[i] + p[i] * p[i];
    }
    printf("t = %g: centre (%.1f, %.1f), spread %.12f, "
           "energy error %.0e\n",
           t, fabs(x), fabs(y), spread, fabs(H - H0));
    tvi_integrator_free(it);
    tvi_system_free(system);
}
