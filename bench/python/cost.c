/* cost.c - Makes the runs of cost.py in C. `cost STEPS REPETITIONS` prints the least CPU time, in seconds, that an
 * integrator takes for so many steps of Kepler's problem; it keeps the state of each step if they are few. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <tvi.h>

enum { FEW = 1000 };
static double kept[FEW][5];

static jet kepler(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_dot(q, q, 2), -0.5));
}

static int keep(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)ctx;
    double *to = kept[step % FEW];
    to[0] = t, to[1] = q[0], to[2] = q[1], to[3] = p[0], to[4] = p[1];
    return 0;
}

static double time_of(const tvi_system *system, long steps)
{
    const tvi_options options = tvi_options_default();
    const clock_t begin = clock();
    double t = 0, q[] = {1, 0}, p[] = {0, 0.8};
    tvi_integrator *integrator;
    if (tvi_integrator_create(&integrator, system, &options) != TVI_OK) return INFINITY;
    const tvi_status status = tvi_integrate(integrator, 0.25, steps, &t, q, p, steps <= FEW ? keep : NULL, NULL);
    tvi_integrator_free(integrator);
    return status == TVI_OK ? (double)(clock() - begin) / CLOCKS_PER_SEC : INFINITY;
}

int main(int argc, char *argv[])
{
    tvi_system *system;
    double least = INFINITY;
    if (argc != 3 || tvi_system_potential(&system, 2, NULL, kepler, NULL) != TVI_OK) return EXIT_FAILURE;
    for (int k = atoi(argv[2]); k > 0; k--) least = fmin(least, time_of(system, atol(argv[1])));
    printf("%.9f\n", least);
    tvi_system_free(system);
    return isfinite(least) ? EXIT_SUCCESS : EXIT_FAILURE;
}
