/* degenerate.c - Defines a scene whose Hamiltonian has no Lagrangian. */
#include "scene.h"

/* H = p sin q + cos q: H_pp = 0, so that it has no Lagrangian. */
static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_mul(p[0], jet_sin(q[0])), jet_cos(q[0]));
}

static const double q0[] = {0.7}, p0[] = {0.4};
static const double steps[] = {0.375,   0.25,     0.1875,    0.125,     0.09375,   0.0625, 0.046875,
                               0.03125, 0.015625, 0.0078125, 1.0 / 256, 1.0 / 512, 0};

/* Checked by tests/generating/test_references_quad.c. */
static const double reference[] = {
    2.0442657166457371579235084e+00,
    1.6612582298313556732796495e+00,
};

const scene scene_degenerate = {
    .name = "degenerate",
    .title = "H = p sin q + cos q, to t = 1.5",
    .time_unit = "",
    .n = 1,
    .hamiltonian = hamiltonian,
    .q = q0,
    .p = p0,
    .t_end = 1.5,
    .energy_scale = 1,
    .reference = reference,
    .steps = steps,
};
