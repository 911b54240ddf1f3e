/* ensemble.h - what ensemble_openmp.c and ensemble_mpi.c share: one orbit of an ensemble of Henon and Heiles'
 * problem. */
#include <tvi.h>

#include <math.h>

enum { ORBITS = 64, STEPS = 400 };

/* V = (x^2 + y^2)/2 + x^2 y - y^3/3 */
static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet bowl = jet_mul(0.5, jet_add(jet_sqr(q[0]), jet_sqr(q[1])));
    return jet_sub(jet_add(bowl, jet_mul(jet_sqr(q[0]), q[1])), jet_div(jet_pow(q[1], 3), 3));
}

/* Orbit number k of energy 1/12, started at x = 0: the largest |x| that it comes to, and its energy error. */
static tvi_status orbit(tvi_integrator *integrator, const tvi_system *system, int k, double *reach, double *error)
{
    const double y = 0.3 * k / ORBITS;
    double t = 0, q[] = {0, y}, p[] = {0, 0}, H0 = 0, H = 0;
    p[0] = sqrt(2 * (1 / 12.0 - y * y / 2 + y * y * y / 3));
    tvi_status status = tvi_energy(system, t, q, p, &H0);
    *reach = *error = 0;
    for (int i = 0; i < STEPS && status == TVI_OK; i++) {
        status = tvi_step(integrator, 0.25, &t, q, p);
        *reach = fmax(*reach, fabs(q[0]));
    }
    if (status == TVI_OK) status = tvi_energy(system, t, q, p, &H);
    *error = fabs(H - H0);
    return status;
}
