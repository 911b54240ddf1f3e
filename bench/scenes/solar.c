/* solar.c - Defines the scene of the outer Solar System. */
#include "references.h"
#include "scene.h"

/* The outer Solar System (Hairer, Lubich and Wanner, Geometric Numerical Integration, I.2.4; docs/method.md section 9):
 * Sun and inner planets, Jupiter, Saturn, Uranus, Neptune, Pluto on 5 September 1994, in AU, days and solar masses.
 *   V = -G sum_{i<j} m_i m_j / |q_i - q_j|. */
enum { BODIES = 6, N = 3 * BODIES };

#define GRAVITY 2.95912208286e-4
#define SUN     1.00000597682
#define JUPITER 0.000954786104043
#define SATURN  0.000285583733151
#define URANUS  0.0000437273164546
#define NEPTUNE 0.0000517759138449
#define PLUTO   (1 / (1.3e8))

#define THREE(m) m, m, m
static const double mass[N] = {THREE(SUN), THREE(JUPITER), THREE(SATURN), THREE(URANUS), THREE(NEPTUNE), THREE(PLUTO)};

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet term[BODIES * (BODIES - 1) / 2];
    int pairs = 0;
    for (int i = 1; i < BODIES; i++)
        for (int j = 0; j < i; j++) {
            jet d[3];
            for (int k = 0; k < 3; k++) d[k] = jet_sub(q[3 * i + k], q[3 * j + k]);
            term[pairs++] = jet_mul(-GRAVITY * mass[3 * i] * mass[3 * j], jet_pow(jet_dot(d, d, 3), -0.5));
        }
    return jet_sum(term, pairs);
}

static const double q0[N] = {
    0,         0,           0,          -3.5023653, -3.8169847,  -1.5507963,  9.0755314,   -3.0458353,  -1.6483708,
    8.3101420, -16.2901086, -7.2521278, 11.4707666, -25.7294829, -10.8169456, -15.5387357, -25.2225594, -3.1902382,
};

/* p = m v; the total momentum is not zero. */
#define MOMENTUM(m, vx, vy, vz) (m) * (vx), (m) * (vy), (m) * (vz)
static const double p0[N] = {
    0,
    0,
    0,
    MOMENTUM(JUPITER, 0.00565429, -0.00412490, -0.00190589),
    MOMENTUM(SATURN, 0.00168318, 0.00483525, 0.00192462),
    MOMENTUM(URANUS, 0.00354178, 0.00137102, 0.00055029),
    MOMENTUM(NEPTUNE, 0.00288930, 0.00114527, 0.00039677),
    MOMENTUM(PLUTO, 0.00276725, -0.00170702, -0.00136504),
};

static const double steps[] = {1250, 1000, 800, 625, 500, 400, 320, 250, 200, 160, 125,
                               100,  80,   50,  40,  25,  20,  10,  5,   2.5, 0};

const scene scene_solar = {
    .name = "solar",
    .title = "Outer Solar System, to 200,000 days",
    .time_unit = "days",
    .n = N,
    .mass = mass,
    .potential = potential,
    .q = q0,
    .p = p0,
    .t_end = 200000,
    .energy_scale = 3.2e-8, /* H0 = -3.21545318320816e-8 */
    .reference = reference_solar,
    .steps = steps,
};
