/* pendulum.c - Defines the scene of a pendulum. */
#include "references.h"
#include "scene.h"

/* V = g (1 - cos q), released at rest from the horizontal: H0 = g, period 2.37. */
static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(9.8, jet_sub(1, jet_cos(q[0])));
}

static const double q0[] = {1.5707963267948966}, p0[] = {0};
static const double steps[] = {0.625,     0.5,       0.3125,     0.25,       0.15625,  0.125,
                               0.078125,  0.0625,    0.0390625,  0.03125,    0.015625, 0.0078125,
                               1.0 / 256, 1.0 / 512, 1.0 / 1024, 1.0 / 2048, 0};

const scene scene_pendulum = {
    .name = "pendulum",
    .title = "Pendulum from pi/2, g = 9.8, to t = 20",
    .time_unit = "s",
    .n = 1,
    .potential = potential,
    .q = q0,
    .p = p0,
    .t_end = 20,
    .energy_scale = 9.8,
    .reference = reference_pendulum,
    .steps = steps,
};
