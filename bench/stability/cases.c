/* cases.c - Defines problems on which methods break (cases.h). */
#include "cases.h"
#include "gravity.h"

#define TWO_PI 6.2831853071795864769
#define FINE   1.1892071150027211 /* 2^(1/4) */
#define COARSE 1.4142135623730951 /* 2^(1/2) */

/* ---- Potentials -------------------------------------------------------------------------------------------------- */

static jet kepler(const jet q[], jet t, void *ctx) { return scene_kepler.potential(q, t, ctx); }
static jet pendulum(const jet q[], jet t, void *ctx) { return scene_pendulum.potential(q, t, ctx); }
static jet henon_heiles(const jet q[], jet t, void *ctx) { return scene_henon_heiles_8.potential(q, t, ctx); }
static jet fpu(const jet q[], jet t, void *ctx) { return scene_fpu.potential(q, t, ctx); }

static jet half_square(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_sqr(q[0]));
}

/* V = L^2 (1 - cos(q/L)). */
static jet scaled_pendulum(const jet q[], jet t, void *ctx)
{
    const double L = *(const double *)ctx;
    (void)t;
    return jet_mul(L * L, jet_sub(1, jet_cos(jet_mul(1 / L, q[0]))));
}

/* A unit mass on a spring of length 1, in a field of 1: V = k/2 (r - 1)^2 + y, k = w^2 = 1e4. */
static jet spring(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet stretch = jet_sub(jet_sqrt(jet_dot(q, q, 2)), 1);
    return jet_add(jet_mul(0.5e4, jet_sqr(stretch)), jet_add(q[1], 1));
}

/* Bodies in the plane. */
enum { MOST_BODIES = 3 };
typedef struct {
    int bodies;
    double mass[MOST_BODIES];
} attraction;

static jet attract(const jet q[], jet t, void *ctx)
{
    const attraction *a = ctx;
    (void)t;
    return gravity_potential(q, a->bodies, 2, a->mass);
}

/* ---- Kepler, from apocentre, a = 1: q = 1 + e, p = sqrt((1 - e)/(1 + e)), H0 = -1/2 ------------------------------ */

#define KEPLER(id, e, p_start, most, least, ratio, order, is_long)                                                     \
    const hard_case kepler_##id = {.scene = {.name = "kepler_" #id,                                                    \
                                             .title = "Kepler, e = " #e,                                               \
                                             .n = 2,                                                                   \
                                             .potential = kepler,                                                      \
                                             .q = (const double[]){1 + e, 0},                                          \
                                             .p = (const double[]){0, p_start},                                        \
                                             .t_end = 1000 * TWO_PI,                                                   \
                                             .energy_scale = 0.5},                                                     \
                                   .period = TWO_PI,                                                                   \
                                   .bound = 1e-2,                                                                      \
                                   .h_most = most,                                                                     \
                                   .h_least = least,                                                                   \
                                   .ladder = ratio,                                                                    \
                                   .least_order = order,                                                               \
                                   .long_run = is_long}

KEPLER(60, 0.6, 0.5, 2, 0.01, COARSE, 2, false);
KEPLER(90, 0.9, 0.229415733870561766, 1, 0.02, COARSE, 8, false);
KEPLER(99, 0.99, 0.0708881205008335901, 0.004, 0.0004, COARSE, 16, true);

/* ---- A pendulum whose energy is a millionth below the separatrix's ----------------------------------------------- */

/* At rest at cos q = -(1 - 2e-6), so that 2g - H0 = 2g 1e-6, and the period is 4 K(k)/sqrt g with k'= 1e-3. With an
 * energy error of 1e-6 it turns over. */
const hard_case separatrix = {
    .scene = {.name = "separatrix",
              .title = "Pendulum, 1e-6 below the separatrix, 100 periods",
              .time_unit = "s",
              .n = 1,
              .potential = pendulum,
              .q = (const double[]){3.13959265325645976},
              .p = (const double[]){0},
              .t_end = 1059.77502180147128,
              .energy_scale = 19.6},
    .period = 10.5977502180147128,
    .bound = 5e-7,
    .h_most = 2,
    .h_least = 1e-3,
    .ladder = FINE,
};

/* ---- Bodies in the plane ----------------------------------------------------------------------------------------- */

/* Burrau's problem: masses 3, 4, 5 at rest in the corners opposite to the sides 3, 4, 5 of a triangle. The first close
 * encounter is at t = 1.88. */
#define EACH_TWICE(a, b, c) a, a, b, b, c, c
static attraction three_four_five = {3, {3, 4, 5}};
const hard_case pythagorean = {
    .scene = {.name = "pythagorean",
              .title = "Pythagorean three bodies, through the first encounter, to t = 2",
              .n = 6,
              .mass = (const double[]){EACH_TWICE(3, 4, 5)},
              .potential = attract,
              .q = (const double[]){1, 3, -2, -1, 1, -1},
              .p = (const double[]){0, 0, 0, 0, 0, 0},
              .t_end = 2,
              .energy_scale = 12.8},
    .ctx = &three_four_five,
    .bound = 1e-2,
    .h_most = 0.5,
    .h_least = 1e-4,
    .ladder = COARSE,
};

/* Chenciner and Montgomery's figure-eight, start and period by Simo, to 14 digits. */
static attraction three_equal = {3, {1, 1, 1}};
const hard_case figure_eight = {
    .scene = {.name = "figure_eight",
              .title = "Figure-eight three bodies, 1000 periods",
              .n = 6,
              .potential = attract,
              .q = (const double[]){0.97000435669734, -0.24308753153583, -0.97000435669734, 0.24308753153583, 0, 0},
              .p = (const double[]){0.46620368572052, 0.43236573046051, 0.46620368572052, 0.43236573046051,
                                    -0.93240737144104, -0.86473146092102},
              .t_end = 6325.91398292621,
              .energy_scale = 1.287},
    .ctx = &three_equal,
    .period = 6.32591398292621,
    .bound = 1e-2,
    .h_most = 4,
    .h_least = 0.02,
    .ladder = COARSE,
};

/* Masses 1 and m = 1e-12, the centre of mass at rest at 0, e = 0.3, a = 1, from apocentre: with M = 1 + m the distance
 * is 1.3, the relative velocity sqrt(M 0.7/1.3), the period 2 pi/sqrt M. */
#define LIGHT    1e-12
#define REDUCED  (LIGHT / (1 + LIGHT))
#define VELOCITY (0.733799385705342819 * (1 + LIGHT / 2))
static attraction sun_and_dust = {2, {1, LIGHT}};
const hard_case unequal_masses = {
    .scene = {.name = "unequal_masses",
              .title = "Two bodies, masses 1 and 1e-12, e = 0.3, 100 periods",
              .n = 4,
              .mass = (const double[]){1, 1, LIGHT, LIGHT},
              .potential = attract,
              .q = (const double[]){-1.3 * REDUCED, 0, 1.3 / (1 + LIGHT), 0},
              .p = (const double[]){0, -REDUCED *VELOCITY, 0, REDUCED *VELOCITY},
              .t_end = 100 * TWO_PI * (1 - LIGHT / 2),
              .energy_scale = 0.5e-12},
    .ctx = &sun_and_dust,
    .period = TWO_PI * (1 - LIGHT / 2),
    .bound = 1e-2,
    .h_most = 4,
    .h_least = 0.01,
    .ladder = COARSE,
};

/* ---- Stiffness and chaos ----------------------------------------------------------------------------------------- */

/* The start of bench/scenes/fpu.c: q = ((1 - 1/w)/sqrt 2, (1 + 1/w)/sqrt 2, 0...), p = (0, sqrt 2, 0...). */
#define FPU(w_, q_0, q_1)                                                                                              \
    static double fpu_w_##w_ = w_;                                                                                     \
    const hard_case fpu_##w_ = {.scene = {.name = "fpu_" #w_,                                                          \
                                          .title = "Fermi-Pasta-Ulam, w = " #w_ ", to t = 10",                         \
                                          .n = 6,                                                                      \
                                          .potential = fpu,                                                            \
                                          .q = (const double[]){q_0, q_1, 0, 0, 0, 0},                                 \
                                          .p = (const double[]){0, 1.4142135623730951, 0, 0, 0, 0},                    \
                                          .t_end = 500.0 / w_,                                                         \
                                          .energy_scale = 2},                                                          \
                                .ctx = &fpu_w_##w_,                                                                    \
                                .bound = 1e-2,                                                                         \
                                .h_most = 20.0 / w_,                                                                   \
                                .h_least = 0.03 / w_,                                                                  \
                                .ladder = FINE}

FPU(50, 0.69296464556281657, 0.72124891681027847);
FPU(100, 0.700035713374682049, 0.714177848998412999);
FPU(200, 0.703571247280614787, 0.710642315092480262);

const hard_case spring_pendulum = {
    .scene = {.name = "spring_pendulum",
              .title = "Pendulum on a stiff spring, w = 100, to t = 50",
              .n = 2,
              .potential = spring,
              .q = (const double[]){1.01, 0},
              .p = (const double[]){0, 0},
              .t_end = 50,
              .energy_scale = 1.5},
    .bound = 1e-2,
    .h_most = 1,
    .h_least = 3e-4,
    .ladder = COARSE,
};

/* H0 = 1/6, the energy of the saddles: the orbit may come as near to them as it likes. */
const hard_case henon_heiles_6 = {
    .scene = {.name = "henon_heiles_6",
              .title = "Henon-Heiles, H = 1/6, to t = 1000",
              .n = 2,
              .potential = henon_heiles,
              .q = (const double[]){0, 0.1},
              .p = (const double[]){0.56, 0.101980390271855697},
              .t_end = 1000,
              .energy_scale = 1.0 / 6},
    .bound = 1e-2,
    .h_most = 8,
    .h_least = 0.05,
    .ladder = COARSE,
};

/* ---- Sizes ------------------------------------------------------------------------------------------------------- */

const hard_case oscillator = {
    .scene = {.name = "oscillator",
              .title = "Harmonic oscillator, w = 1, 10 periods",
              .n = 1,
              .potential = half_square,
              .q = (const double[]){1},
              .p = (const double[]){0},
              .t_end = 10 * TWO_PI,
              .energy_scale = 0.5},
    .period = TWO_PI,
    .bound = 1e-2,
    .h_most = 8,
    .h_least = 0.01,
    .ladder = FINE,
};

#define PENDULUM(size, L_, title_)                                                                                     \
    static double length_##size = L_;                                                                                  \
    const hard_case pendulum_##size = {.scene = {.name = "pendulum_" #size,                                            \
                                                 .title = title_,                                                      \
                                                 .n = 1,                                                               \
                                                 .potential = scaled_pendulum,                                         \
                                                 .q = (const double[]){1.5 * (L_)},                                    \
                                                 .p = (const double[]){0.3 * (L_)},                                    \
                                                 .t_end = 20,                                                          \
                                                 .energy_scale = (L_) * (L_)},                                         \
                                       .ctx = &length_##size,                                                          \
                                       .bound = 1e-2,                                                                  \
                                       .h_most = 8,                                                                    \
                                       .h_least = 0.01,                                                                \
                                       .ladder = FINE}

PENDULUM(tiny, 0x1p-498, "Pendulum of length 2^-498, to t = 20");
PENDULUM(unit, 1.0, "Pendulum of length 1, to t = 20");
PENDULUM(huge, 0x1p498, "Pendulum of length 2^498, to t = 20");

#define SIZED_KEPLER(id, size)                                                                                         \
    const hard_case kepler_##id = {.scene = {.name = "kepler_" #id,                                                    \
                                             .title = "Kepler, |q| = " #size,                                          \
                                             .n = 2,                                                                   \
                                             .potential = kepler,                                                      \
                                             .q = (const double[]){size, 0},                                           \
                                             .p = (const double[]){0, size},                                           \
                                             .t_end = 1,                                                               \
                                             .energy_scale = 1},                                                       \
                                   .bound = 1e-2,                                                                      \
                                   .h_most = 1,                                                                        \
                                   .h_least = 0.01,                                                                    \
                                   .ladder = FINE}

SIZED_KEPLER(tiny, 1e-150);
SIZED_KEPLER(huge, 1e150);

/* ---- The list ---------------------------------------------------------------------------------------------------- */

const hard_case *const hard_cases[] = {
    &kepler_60,       &kepler_90,      &kepler_99,    &separatrix,     &pythagorean,
    &spring_pendulum, &henon_heiles_6, &figure_eight, &unequal_masses, NULL,
};

tvi_status hard_system(const hard_case *c, tvi_system **out)
{
    return tvi_system_potential(out, c->scene.n, c->scene.mass, c->scene.potential, c->ctx);
}
