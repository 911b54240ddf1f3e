/* magnetic.c - Defines the scene of a charge in a magnetic bottle. */
#include "scene.h"

/* A charge in a magnetic bottle, B = (-x z, -y z, 1 + z^2), of the vector potential A = (1 + z^2)/2 (-y, x, 0):
 *   L = m/2 |v|^2 + e A.v,  m = 3/4, e = 5/4.
 * It turns about the axis, and back and forth along it; x p_y - y p_x is kept. */
#define MASS   0.75
#define CHARGE 1.25

static jet lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet turning = jet_sub(jet_mul(q[0], v[1]), jet_mul(q[1], v[0]));
    jet coupling = jet_mul(CHARGE / 2, jet_mul(jet_add(1, jet_sqr(q[2])), turning));
    return jet_add(jet_mul(MASS / 2, jet_dot(v, v, 3)), coupling);
}

/* p = m v + e A for v = (1/4, 1, 1/2). */
static const double q0[] = {0.5, 0, 0.25}, p0[] = {0.1875, 1.08203125, 0.375};
static const double steps[] = {1.25,     1,      0.625,   0.5,      0.3125,    0.25,      0.15625,   0.125,
                               0.078125, 0.0625, 0.03125, 0.015625, 0.0078125, 1.0 / 256, 1.0 / 512, 0};

/* Checked by tests/generating/test_references_quad.c. */
static const double reference[] = {
    8.7645916064167931995581809e-01,  1.0183477886958243057367907e-01, -1.2697577520082247331610516e+00,
    -1.4942620188276037172433535e-02, 6.1553803166643466422634508e-01, 2.2459943613263401882564506e-01,
};

const scene scene_magnetic = {
    .name = "magnetic",
    .title = "Charge in a magnetic bottle, to t = 5",
    .time_unit = "",
    .n = 3,
    .lagrangian = lagrangian,
    .q = q0,
    .p = p0,
    .t_end = 5,
    .energy_scale = 0.5,
    .reference = reference,
    .steps = steps,
};
