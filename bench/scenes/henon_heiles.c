/* henon_heiles.c - Defines the scenes of Henon and Heiles' problem. */
#include "references.h"
#include "scene.h"

/* V = (x^2 + y^2)/2 + x^2 y - y^3/3. */
static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet xx = jet_sqr(q[0]), yy = jet_sqr(q[1]);
    return jet_add(jet_mul(0.5, jet_add(xx, yy)), jet_mul(q[1], jet_sub(xx, jet_div(yy, 3))));
}

static const double steps[] = {2,       1.5625, 1.25,     1,      0.78125, 0.625,    0.5,       0.390625,  0.3125, 0.25,
                               0.15625, 0.125,  0.078125, 0.0625, 0.03125, 0.015625, 0.0078125, 1.0 / 256, 0};

/* H0 = 1/12: regular. */
static const double q_12[] = {0.25, -0.25}, p_12[] = {0.25, 0};

const scene scene_henon_heiles_12 = {
    .name = "henon_heiles_12",
    .title = "Henon-Heiles, H = 1/12 (regular), to t = 100",
    .time_unit = "",
    .n = 2,
    .potential = potential,
    .q = q_12,
    .p = p_12,
    .t_end = 100,
    .energy_scale = 1.0 / 12,
    .reference = reference_henon_heiles_12,
    .steps = steps,
};

/* H0 = 1/8: chaotic with exponent 0.046, so that an error grows about a hundredfold to t = 100. */
static const double q_8[] = {0.25, 0.375}, p_8[] = {0.1875, 0};

const scene scene_henon_heiles_8 = {
    .name = "henon_heiles_8",
    .title = "Henon-Heiles, H = 1/8 (chaotic), to t = 100",
    .time_unit = "",
    .n = 2,
    .potential = potential,
    .q = q_8,
    .p = p_8,
    .t_end = 100,
    .energy_scale = 1.0 / 8,
    .reference = reference_henon_heiles_8,
    .steps = steps,
};
