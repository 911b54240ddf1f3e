/* kepler.c - Defines the scene of Kepler's problem with e = 0.36. */
#include "references.h"
#include "scene.h"

/* V = -1/r, from apocentre: e = 0.36, a = 1/1.36, H0 = -0.68, period 3.9616. To t = 250, 63 revolutions. */
static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_dot(q, q, 2), -0.5));
}

static const double q0[] = {1, 0}, p0[] = {0, 0.8};
static const double steps[] = {0.625,    0.5,       0.390625,  0.3125,    0.25,       0.1953125,
                               0.15625,  0.125,     0.078125,  0.0625,    0.0390625,  0.03125,
                               0.015625, 0.0078125, 1.0 / 256, 1.0 / 512, 1.0 / 1024, 0};

const scene scene_kepler = {
    .name = "kepler",
    .title = "Kepler, e = 0.36, to t = 250",
    .time_unit = "",
    .n = 2,
    .potential = potential,
    .q = q0,
    .p = p0,
    .t_end = 250,
    .energy_scale = 0.68,
    .reference = reference_kepler,
    .steps = steps,
};
