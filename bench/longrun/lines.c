/* lines.c - Lists the rows of the table of docs/roundoff.md. */
#include "longrun.h"

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

/* The magnetic bottle of scenes/magnetic.c as H = |p - e A|^2 / (2m), A = (1 + z^2)/2 (-y, x, 0), with v_y = -1. The
 * angular momentum l = x p_y - y p_x < 0 holds the charge where e (1 + z^2) |l| <= m H. */
static jet bottle(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const double mass = 0.75, charge = 1.25;
    const jet field = jet_mul(charge / 2, jet_add(1, jet_sqr(q[2])));
    const jet v[3] = {jet_add(p[0], jet_mul(field, q[1])), jet_sub(p[1], jet_mul(field, q[0])), p[2]};
    return jet_mul(1 / (2 * mass), jet_dot(v, v, 3));
}

static const double bottle_q[] = {0.5, 0, 0.25}, bottle_p[] = {0.1875, -0.41796875, 0.375};
static const scene scene_bottle = {
    .name = "bottle", .n = 3, .hamiltonian = bottle, .q = bottle_q, .p = bottle_p, .energy_scale = 0.49};

/* A mass on a spring that swings in space: V = k/2 (|q| - l)^2 + m g z. */
static jet spring(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const double stiffness = 23.7, length = 0.83, weight = 1.3 * 1.07;
    const jet stretch = jet_sub(jet_sqrt(jet_dot(q, q, 3)), length);
    return jet_add(jet_mul(stiffness / 2, jet_sqr(stretch)), jet_mul(weight, q[2]));
}

static const double spring_mass[] = {1.3, 1.3, 1.3}, spring_q[] = {0.41, -0.23, -0.87}, spring_p[] = {0.29, 0.53, 0.37};
static const scene scene_spring = {.name = "spring",
                                   .n = 3,
                                   .mass = spring_mass,
                                   .potential = spring,
                                   .q = spring_q,
                                   .p = spring_p,
                                   .energy_scale = 0.5};

static jet scale(const jet q[], const jet p[], jet t, void *ctx) { return hard_kepler_90.scale(q, p, t, ctx); }

/* ---- Rows -------------------------------------------------------------------------------------------------------- */

#define CENTURIES (1000 * 36525.0) /* a thousand, in days */

#define GALERKIN .method = "galerkin", .order = 16
#define KEPLER   .scene = &scene_kepler, .title = "Kepler", .form = "potential", .steps = 3e6, .has_momentum = true
/* Steps whose passes contract slowly; the energy has their truncation. */
#define SLOW                                                                                                           \
    .scene = &scene_kepler, .title = "Kepler", .form = "potential", .steps = 3e5, .has_momentum = true, .orbits = 96
#define SOLAR(h_, steps_)                                                                                              \
    .scene = &scene_solar, .title = "outer Solar System", .form = "potential", .h = h_, .steps = steps_,               \
    .rms_most = 2e-14
#define SLOW_SOLAR SOLAR(625, CENTURIES / 625), .has_momentum = true, .orbits = 256
#define BOTTLE     .scene = &scene_bottle, .title = "magnetic bottle", .form = "Hamiltonian", .has_momentum = true
#define SPRING     .scene = &scene_spring, .title = "elastic pendulum", .form = "potential", .has_momentum = true
#define DOUBLE     .scene = &scene_double_pendulum, .title = "double pendulum", .form = "Lagrangian"

/* Constraints; "constrained" is the scene of all of them. */
#define ON(system, title_, form_, h_, steps_)                                                                          \
    .scene = &system.scene, .constraints = &system, .title = title_, .form = form_, .h = h_, .steps = steps_
#define ROD(steps_) ON(longrun_pendulum, "pendulum on a rod", "constraints", 0.1, steps_)
#define RODS        ON(longrun_double_pendulum, "double pendulum on rods", "constraints", 0.015625, 3e5)
#define WATER       ON(longrun_water, "water", "constraints", 0.2, 1e5), .has_momentum = true
#define EULER_TOP   ON(longrun_euler_top, "Euler's top", "rigid body", 0.2, 1e5), .has_momentum = true
#define HEAVY_TOP   ON(longrun_heavy_top, "heavy top", "rigid body", 0.05, 1e5), .has_momentum = true

#define RESCALED .scene = &hard_kepler_90.scene, .title = "Kepler, e = 0.9", .form = "rescaled", .has_momentum = true

/* Unless it says otherwise a row has compensated sums and must hold. */
const longrun_line longrun_lines[] = {
    {KEPLER, GALERKIN, .h = 0.1, .orbits = 96},
    {KEPLER, GALERKIN, .h = 0.25, .orbits = 96},
    {SOLAR(100, CENTURIES / 100), GALERKIN, .orbits = 128},
    {SOLAR(250, CENTURIES / 250), GALERKIN, .orbits = 256},
    {SOLAR(400, CENTURIES / 400), GALERKIN, .orbits = 256},
    {BOTTLE, GALERKIN, .h = 0.1, .steps = 1e6, .orbits = 128},
    {SPRING, GALERKIN, .h = 0.1, .steps = 1e6, .orbits = 128},
    {DOUBLE, GALERKIN, .h = 0.015625, .steps = 1e6, .orbits = 128},
    {RESCALED, GALERKIN, .scale = scale, .h = 0.83, .steps = 1e5, .orbits = 128, .rms_most = 1e-12},
    {ROD(1e6), GALERKIN, .orbits = 64},
    {RODS, GALERKIN, .orbits = 64},
    {WATER, GALERKIN, .orbits = 64},
    {EULER_TOP, GALERKIN, .orbits = 64},
    {HEAVY_TOP, GALERKIN, .orbits = 64},
    {KEPLER, GALERKIN, .h = 0.1, .sums = LONGRUN_ROUNDED, .orbits = 24, .duty = {LONGRUN_FAILS, LONGRUN_SHOWN}},
    {SOLAR(250, CENTURIES / 250), GALERKIN, .sums = LONGRUN_ROUNDED, .orbits = 32, .duty = {LONGRUN_FAILS}},
    {SOLAR(400, CENTURIES / 400), GALERKIN, .sums = LONGRUN_ROUNDED, .orbits = 32, .duty = {LONGRUN_FAILS}},
    {SOLAR(100, CENTURIES / 100), GALERKIN, .sums = LONGRUN_PLAIN, .orbits = 64, .duty = {LONGRUN_FAILS}},
    {SLOW, GALERKIN, .h = 0.7, .duty = {LONGRUN_SHOWN}},
    {SLOW, GALERKIN, .h = 0.7, .sums = LONGRUN_SOONER, .duty = {LONGRUN_SHOWN, LONGRUN_FAILS}},
    {ROD(3e5), GALERKIN, .sums = LONGRUN_NEAREST, .orbits = 32, .duty = {LONGRUN_FAILS}},
    {WATER, GALERKIN, .sums = LONGRUN_NEAREST, .orbits = 32, .duty = {LONGRUN_FAILS, LONGRUN_SHOWN}},
    {ROD(3e5), GALERKIN, .sums = LONGRUN_PLAIN, .orbits = 32, .duty = {LONGRUN_FAILS}},
    {SLOW_SOLAR, GALERKIN, .duty = {LONGRUN_SHOWN}},
    {SOLAR(100, CENTURIES / 400), .method = "midpoint", .order = 16, .orbits = 32, .duty = {LONGRUN_SHOWN}},
    {.scene = NULL},
};
