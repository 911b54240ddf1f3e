/* blas.c - Prints the bits of a run whose equations are solved by LAPACK, of fewer and of more rows than
 * LAPACK_THREADED_MIN_ROWS (algebra/linear.c): bodies whose Lagrangian does not separate, some steps.
 * tests/blas_threads.sh compares what it prints. */
#include "tvi.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BODIES = 130 };

static int bodies;

/* L = sum_i [(1 + q_i^2) v_i^2 - (q_i - q_{i+1})^2] / 2 + sum_k (sum_i cos(i k) v_i)^2 / 2n, whose L_vv is full. */
static jet coupled(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet L = jet_const(0);
    for (int i = 0; i < bodies; i++) {
        L = jet_add(L, jet_mul(0.5, jet_mul(jet_add(1, jet_sqr(q[i])), jet_sqr(v[i]))));
        if (i + 1 == bodies) continue;
        L = jet_sub(L, jet_mul(0.5, jet_sqr(jet_sub(q[i], q[i + 1]))));
    }
    for (int k = 0; k < 5; k++) {
        jet sum = jet_const(0);
        for (int i = 0; i < bodies; i++) sum = jet_add(sum, jet_mul(cos(1.0 + i * k), v[i]));
        L = jet_add(L, jet_mul(0.5 / bodies, jet_sqr(sum)));
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
    if (tvi_system_lagrangian(&system, bodies, coupled, NULL) != TVI_OK) return EXIT_FAILURE;
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
