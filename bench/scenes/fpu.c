/* fpu.c - Defines the scene of a Fermi-Pasta-Ulam chain. */
#include "references.h"
#include "scene.h"

/* Fermi-Pasta-Ulam chain of six unit masses, three stiff springs of frequency w = 50 between soft ones, q_0 = q_7 = 0
 * (docs/method.md section 9 in q):
 *   V = w^2/4 sum_{i=1..3} (q_{2i} - q_{2i-1})^2 + sum_{i=0..3} (q_{2i+1} - q_{2i})^4.
 * A context is another w. */
enum { N = 6 };

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t;
    const double w = ctx ? *(const double *)ctx : 50;
    jet x[N + 2], stiff[3], soft[4];
    x[0] = x[N + 1] = jet_const(0);
    for (int i = 0; i < N; i++) x[i + 1] = q[i];
    for (int i = 1; i <= 3; i++) stiff[i - 1] = jet_sqr(jet_sub(x[2 * i], x[2 * i - 1]));
    for (int i = 0; i <= 3; i++) soft[i] = jet_pow(jet_sub(x[2 * i + 1], x[2 * i]), 4);
    return jet_add(jet_mul(w * w / 4, jet_sum(stiff, 3)), jet_sum(soft, 4));
}

/* q = ((1 - 1/w)/sqrt 2, (1 + 1/w)/sqrt 2, 0...), p = (0, sqrt 2, 0...): H0 = 2.00120008. To t = 10 there are 80
 * periods of the stiff springs, and an error of the start grows twentyfold (to t = 100, 17,000-fold). */
static const double q0[N] = {0.69296464556281657, 0.72124891681027847}, p0[N] = {0, 1.4142135623730951};
static const double steps[] = {0.078125,    0.0625,     0.0390625,  0.03125,   0.01953125, 0.015625,
                               0.009765625, 0.0078125,  5.0 / 1024, 1.0 / 256, 5.0 / 2048, 1.0 / 512,
                               1.0 / 1024,  1.0 / 2048, 1.0 / 4096, 0};

const scene scene_fpu = {
    .name = "fpu",
    .title = "Fermi-Pasta-Ulam, w = 50, to t = 10",
    .time_unit = "",
    .n = N,
    .potential = potential,
    .q = q0,
    .p = p0,
    .t_end = 10,
    .energy_scale = 2,
    .reference = reference_fpu,
    .steps = steps,
};
