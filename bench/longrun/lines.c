/* lines.c - the rows of the table of docs/roundoff.md. */
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

/* ---- Rows -------------------------------------------------------------------------------------------------------- */

#define DAYS_A_YEAR 365.25
#define CENTURIES   (1000 * 100 * DAYS_A_YEAR) /* a thousand of them, in days */

/* clang-format off */
#define KEPLER(h_, sums_, orbits_, energy_, momentum_)                                                                 \
    {.scene = &scene_kepler, .title = "Kepler", .form = "potential", .method = "galerkin", .order = 16, .sums = sums_, \
     .h = h_, .steps = 3e6, .orbits = orbits_, .has_momentum = true, .duty = {energy_, momentum_}}
#define SOLAR(h_, method_, sums_, orbits_, duty_)                                                                      \
    {.scene = &scene_solar, .title = "outer Solar System", .form = "potential", .method = method_, .order = 16,        \
     .sums = sums_, .h = h_, .steps = CENTURIES / (h_), .orbits = orbits_, .duty = {duty_}, .rms_most = 2e-14}
#define OTHER(scene_, title_, form_, h_, orbits_, momentum_)                                                           \
    {.scene = &scene_, .title = title_, .form = form_, .method = "galerkin", .order = 16, .h = h_, .steps = 1e6,       \
     .orbits = orbits_, .has_momentum = momentum_}
/* clang-format on */

const longrun_line longrun_lines[] = {
    KEPLER(0.1, LONGRUN_COMPENSATED, 128, LONGRUN_HOLDS, LONGRUN_HOLDS),
    KEPLER(0.25, LONGRUN_COMPENSATED, 128, LONGRUN_HOLDS, LONGRUN_HOLDS),
    SOLAR(100, "galerkin", LONGRUN_COMPENSATED, 128, LONGRUN_HOLDS),
    SOLAR(250, "galerkin", LONGRUN_COMPENSATED, 192, LONGRUN_HOLDS),
    SOLAR(400, "galerkin", LONGRUN_COMPENSATED, 192, LONGRUN_HOLDS),
    OTHER(scene_bottle, "magnetic bottle", "Hamiltonian", 0.1, 128, true),
    OTHER(scene_spring, "elastic pendulum", "potential", 0.1, 192, true),
    OTHER(scene_double_pendulum, "double pendulum", "Lagrangian", 0.03125, 72, false),
    KEPLER(0.1, LONGRUN_ROUNDED, 24, LONGRUN_FAILS, LONGRUN_SHOWN),
    SOLAR(250, "galerkin", LONGRUN_ROUNDED, 32, LONGRUN_FAILS),
    SOLAR(400, "galerkin", LONGRUN_ROUNDED, 32, LONGRUN_FAILS),
    SOLAR(100, "galerkin", LONGRUN_PLAIN, 64, LONGRUN_FAILS),
    SOLAR(100, "midpoint", LONGRUN_COMPENSATED, 32, LONGRUN_SHOWN),
    {.scene = NULL},
};
