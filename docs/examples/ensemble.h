/* ensemble.h - what ensemble.c and ensemble_mpi.c share: orbits of Henon and Heiles' problem with energy 1/12. */
#include <tvi.h>

#include <math.h>
#include <stdio.h>

enum { ORBITS = 64, N = 2 };

/* V = (x^2 + y^2)/2 + x^2 y - y^3/3 */
static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet bowl = jet_mul(0.5, jet_add(jet_sqr(q[0]), jet_sqr(q[1])));
    return jet_sub(jet_add(bowl, jet_mul(jet_sqr(q[0]), q[1])), jet_div(jet_pow(q[1], 3), 3));
}

/* Orbits first ... first + members - 1 as the members of an ensemble, started at x = 0: arrays are [n][members]. */
static void start(int first, int members, double t[], double q[], double p[])
{
    for (int m = 0; m < members; m++) {
        const double y = 0.3 * (first + m) / ORBITS;
        t[m] = q[m] = p[members + m] = 0;
        q[members + m] = y;
        p[m] = sqrt(2 * (1 / 12.0 - y * y / 2 + y * y * y / 3));
    }
}

/* Returns the error of the energy of member m, 1/12 at the start. */
static double energy_error(const tvi_system *system, int members, int m, const double q[], const double p[])
{
    double H = 0;
    const tvi_status status =
        tvi_energy(system, 0, (double[]){q[m], q[members + m]}, (double[]){p[m], p[members + m]}, &H);
    return status == TVI_OK ? fabs(H - 1 / 12.0) : 1;
}

/* Reads the texts of all members, one after the other, of `each` characters; or writes them. */
static inline int move(tvi_ensemble *all, int members, int reads, char *text, size_t each, double t[], double q[],
                       double p[])
{
    tvi_status status = TVI_OK;
    for (int m = 0; m < members && status == TVI_OK; m++, text += each)
        status = reads ? tvi_ensemble_member_from_text(all, m, text, each, t, q, p)
                       : tvi_ensemble_member_to_text(all, m, t, q, p, text, &each);
    return status == TVI_OK;
}
