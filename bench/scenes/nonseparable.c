/* nonseparable.c - Defines a scene whose Hamiltonian is not separable. */
#include "scene.h"

/* H = (q^2 + 1)(p^2 + 1)/2: no sum of a part of q and a part of p. */
static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_mul(jet_add(jet_sqr(q[0]), 1), jet_add(jet_sqr(p[0]), 1)));
}

static const double q0[] = {0.3}, p0[] = {0.5};
static const double steps[] = {0.5,       0.25,      0.125,     0.0625,     0.03125, 0.015625,
                               0.0078125, 1.0 / 256, 1.0 / 512, 1.0 / 1024, 0};

/* Checked by tests/generating/test_references_quad.c. */
static const double reference[] = {
    2.3065083131551309921908428e-01,
    -5.4191941564083727142265567e-01,
};

const scene scene_nonseparable = {
    .name = "nonseparable",
    .title = "H = (q^2 + 1)(p^2 + 1)/2, to t = 2",
    .time_unit = "",
    .n = 1,
    .hamiltonian = hamiltonian,
    .q = q0,
    .p = p0,
    .t_end = 2,
    .energy_scale = 0.68,
    .reference = reference,
    .steps = steps,
};
