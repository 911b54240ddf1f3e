/* vortices.c - Defines the scene of four point vortices. */
#include "scene.h"

/* Four point vortices of circulations G_i at (x_i, y_i), Kirchhoff's equations G_i x_i' = H_{y_i}, G_i y_i' = -H_{x_i}
 * with, in units of time that take up a factor 4 pi,
 *   H = -sum_{i<j} G_i G_j log((x_i - x_j)^2 + (y_i - y_j)^2),
 * canonical in q_i = sqrt(G_i) x_i, p_i = sqrt(G_i) y_i. H_pp is singular everywhere, as H is the same after a shift.
 * Kept: sum G_i x_i, sum G_i y_i and sum G_i (x_i^2 + y_i^2). */
enum { N = 4 };
static const double root[N] = {1, 2, 1, 0.5}; /* sqrt(G_i) */

static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet term[N * (N - 1) / 2];
    int pairs = 0;
    for (int i = 1; i < N; i++)
        for (int j = 0; j < i; j++) {
            jet x = jet_sub(jet_div(q[i], root[i]), jet_div(q[j], root[j]));
            jet y = jet_sub(jet_div(p[i], root[i]), jet_div(p[j], root[j]));
            const double strength = root[i] * root[i] * root[j] * root[j];
            term[pairs++] = jet_mul(-strength, jet_log(jet_add(jet_sqr(x), jet_sqr(y))));
        }
    return jet_sum(term, pairs);
}

/* (x, y) = (1, 0), (0, 0.25), (-1, -0.5), (0.25, -1). */
static const double q0[N] = {1, 0, -1, 0.125}, p0[N] = {0, 0.5, -0.5, -0.5};
static const double steps[] = {0.15625,  0.125,     0.078125,  0.0625,    0.0390625,  0.03125,    0.01953125,
                               0.015625, 0.0078125, 1.0 / 256, 1.0 / 512, 1.0 / 1024, 1.0 / 2048, 0};

/* Checked by tests/generating/test_references_quad.c. */
static const double reference[] = {
    -8.5541904617731222182613701e-01, 3.3122873491953307295868847e-01,  4.1324496806549698884340644e-01,
    -3.1556678345450182586929273e-01, -6.5158449160351002298652330e-01, -1.6223319384238296068468932e-01,
    9.7218719103298130806917163e-01,  5.0772737651058927257346063e-01,
};

const scene scene_vortices = {
    .name = "vortices",
    .title = "Four point vortices, to t = 1.25",
    .time_unit = "",
    .n = N,
    .hamiltonian = hamiltonian,
    .q = q0,
    .p = p0,
    .t_end = 1.25,
    .energy_scale = 5,
    .reference = reference,
    .steps = steps,
};
