/* blas.c - the bits of a run whose equations are solved by LAPACK, of fewer and of more rows than DGETRF_BELOW (src/linear.c):
 * a chain whose Lagrangian does not separate, n bodies, some steps. tests/blas_threads.sh compares what it prints. */
#include "tvi.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BODIES = 130 };

static int bodies;

/* L = sum_i (1 + q_i^2) v_i^2 / 2 + v_i v_{i+1} / 10 - (q_i - q_{i+1})^2 / 2. */
static jet chain(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet L = jet_const(0);
    for (int i = 0; i < bodies; i++) {
        L = jet_add(L, jet_mul(0.5, jet_mul(jet_add(1, jet_sqr(q[i])), jet_sqr(v[i]))));
        if (i + 1 == bodies) continue;
        L = jet_add(L, jet_mul(0.1, jet_mul(v[i], v[i + 1])));
        L = jet_sub(L, jet_mul(0.5, jet_sqr(jet_sub(q[i], q[i + 1]))));
    }
    return L;
}

int main(int argc, char *argv[])
{
    bodies = argc > 1 ? atoi(argv[1]) : 0;
    if (bodies < 1 || bodies > BODIES) return EXIT_FAILURE;
    double t = 0, q[BODIES], p[BODIES];
    for (int i = 0; i < bodies; i++) q[i] = 1.0 / (1 + i), p[i] = 0.5 / (2 + i);
    tvi_system *system;
    tvi_integrator *integrator;
    tvi_options options;
    if (tvi_options_named("midpoint", 4, &options) != TVI_OK) return EXIT_FAILURE;
    if (tvi_system_lagrangian(&system, bodies, chain, NULL) != TVI_OK) return EXIT_FAILURE;
    if (tvi_integrator_create(&integrator, system, &options) != TVI_OK) return EXIT_FAILURE;
    if (tvi_integrate(integrator, 0.05, 3, &t, q, p, NULL, NULL) != TVI_OK) return EXIT_FAILURE;
    for (int i = 0; i < bodies; i++) {
        uint64_t bits[2];
        memcpy(bits, &q[i], sizeof *bits);
        memcpy(bits + 1, &p[i], sizeof *bits);
        printf("%" PRIx64 " %" PRIx64 "\n", bits[0], bits[1]);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return EXIT_SUCCESS;
}
