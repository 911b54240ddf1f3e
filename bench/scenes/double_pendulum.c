/* double_pendulum.c - Defines the scene of a double pendulum, and one with parameters. */
#include "scene.h"

/* Two pendulums, one below the other, with angles q from the vertical:
 *   L = (m1 + m2)/2 l1^2 v1^2 + m2/2 l2^2 v2^2 + m2 l1 l2 v1 v2 cos(q1 - q2) + (m1 + m2) g l1 cos q1 + m2 g l2 cos q2
 * with m = (1, 5/8), l = (1, 3/4), g = 9.8125: every product is exact in double. */
#define MASS_1   1.0
#define MASS_2   0.625
#define LENGTH_1 1.0
#define LENGTH_2 0.75
#define GRAVITY  9.8125

static jet lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const double both = MASS_1 + MASS_2;
    jet upper = jet_mul(both * LENGTH_1 * LENGTH_1 / 2, jet_sqr(v[0]));
    jet lower = jet_mul(MASS_2 * LENGTH_2 * LENGTH_2 / 2, jet_sqr(v[1]));
    jet mixed = jet_mul(MASS_2 * LENGTH_1 * LENGTH_2, jet_mul(jet_mul(v[0], v[1]), jet_cos(jet_sub(q[0], q[1]))));
    jet weight =
        jet_add(jet_mul(both * GRAVITY * LENGTH_1, jet_cos(q[0])), jet_mul(MASS_2 * GRAVITY * LENGTH_2, jet_cos(q[1])));
    return jet_add(jet_add(upper, lower), jet_add(mixed, weight));
}

jet double_pendulum_with_parameters(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet g = jet_parameter(q[0], 0, 9.8), m = jet_parameter(q[0], 1, 1);
    const jet upper = jet_mul(jet_add(1, m), jet_div(jet_sqr(v[0]), 2)), lower = jet_mul(m, jet_div(jet_sqr(v[1]), 2));
    const jet both = jet_mul(m, jet_mul(jet_mul(v[0], v[1]), jet_cos(jet_sub(q[0], q[1]))));
    const jet weight = jet_add(jet_mul(jet_add(1, m), jet_cos(q[0])), jet_mul(m, jet_cos(q[1])));
    return jet_add(jet_add(upper, jet_add(lower, both)), jet_mul(g, weight));
}

/* Both angles large and opposite. */
static const double q0[] = {1, -0.75}, p0[] = {0.5, -0.25};
static const double steps[] = {0.3125,     0.25,     0.15625,   0.125,     0.078125,  0.0625,     0.0390625, 0.03125,
                               0.01953125, 0.015625, 0.0078125, 1.0 / 256, 1.0 / 512, 1.0 / 1024, 0};

/* Checked by tests/generating/test_references_quad.c. */
static const double reference[] = {
    -2.3198964798529972126674885e-01,
    2.0570442168104236586576130e+00,
    -2.2280370694472705516079651e+00,
    4.9891851756769006329177866e-01,
};

const scene scene_double_pendulum = {
    .name = "double_pendulum",
    .title = "Double pendulum, to t = 2.5",
    .time_unit = "s",
    .n = 2,
    .lagrangian = lagrangian,
    .q = q0,
    .p = p0,
    .t_end = 2.5,
    .energy_scale = 12,
    .reference = reference,
    .steps = steps,
};
