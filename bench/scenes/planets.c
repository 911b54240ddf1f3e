/* planets.c - The Sun and eight planets, the scene of bench/peers. */
#include "references.h"
#include "scene.h"
#include "tvi_bodies.h"

/* The Sun and eight planets, near where they are on 1 January 2000, in AU and days. The masses are G m, and G = 1.
 * Masses and velocities have 24 bits each, so that momenta and products of masses are exact, and every program has the
 * same problem to the last bit. */
enum { BODIES = 9, N = 3 * BODIES };

#define SUN     2.95912208e-04f
#define MERCURY 4.91254745e-11f
#define VENUS   7.24345249e-10f
#define EARTH   8.99701139e-10f
#define MARS    9.54953511e-11f
#define JUPITER 2.82534591e-07f
#define SATURN  8.45971519e-08f
#define URANUS  1.29202492e-08f
#define NEPTUNE 1.52435890e-08f

static const double bodies_mass[BODIES] = {SUN, MERCURY, VENUS, EARTH, MARS, JUPITER, SATURN, URANUS, NEPTUNE};
static const tvi_bodies bodies = {.bodies = BODIES, .axes = 3, .mass = bodies_mass};

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    return tvi_bodies_potential(q, t, (void *)&bodies);
}

#define THREE(m) m, m, m
static const double mass[N] = {THREE(SUN),     THREE(MERCURY), THREE(VENUS),  THREE(EARTH),  THREE(MARS),
                               THREE(JUPITER), THREE(SATURN),  THREE(URANUS), THREE(NEPTUNE)};

/* The barycentre is at rest at 0. */
static const double q0[N] = {
    -0.007135546799, -0.002795595637, 0.0002061215343, /* the Sun */
    -0.1372241672,   -0.4500879322,   -0.02439269818,  /* Mercury */
    -0.7254519024,   -0.03550225727,  0.04122174588,   /* Venus */
    -0.1843067959,   0.9644188893,    0.000205863085,  /* the Earth with the Moon */
    1.383532201,     -0.0161866598,   -0.03425513769,  /* Mars */
    3.991185393,     2.942915315,     -0.1015116931,   /* Jupiter */
    6.40764894,      6.542871869,     -0.3689406513,   /* Saturn */
    14.41833034,     -13.74044132,    -0.2378269988,   /* Uranus */
    16.79762727,     -24.99550546,    0.1276093316,    /* Neptune */
};

#define MOMENTUM(m, vx, vy, vz) (double)(m) * (vx), (double)(m) * (vy), (double)(m) * (vz)
static const double p0[N] = {
    MOMENTUM(SUN, 5.3786226e-06f, -7.399979e-06f, -9.4324556e-08f),
    MOMENTUM(MERCURY, 0.021371654f, -0.0064552946f, -0.0024879308f),
    MOMENTUM(VENUS, 0.00080420814f, -0.020302249f, -0.00032356039f),
    MOMENTUM(EARTH, -0.017197765f, -0.0031716593f, -9.3479035e-08f),
    MOMENTUM(MARS, 0.00067797043f, 0.015180421f, 0.00030152907f),
    MOMENTUM(JUPITER, -0.0045666761f, 0.0064283872f, 7.5636883e-05f),
    MOMENTUM(SATURN, -0.0042762756f, 0.0038862509f, 0.00010232281f),
    MOMENTUM(URANUS, 0.002687126f, 0.0026562411f, -2.4970894e-05f),
    MOMENTUM(NEPTUNE, 0.0025887586f, 0.0017610146f, -9.6037518e-05f),
};

const scene scene_planets = {
    .name = "planets",
    .title = "Sun and eight planets, to 91,320 days",
    .time_unit = "days",
    .n = N,
    .mass = mass,
    .potential = potential,
    .q = q0,
    .p = p0,
    .t_end = 91320,
    .energy_scale = 9.8e-12, /* H0 = -9.84e-12 */
    .reference = reference_planets,
};
