/* comet.c - Defines the scene of a comet that passes the Sun and Jupiter. */
#include "hard.h"
#include "references.h"

#include <math.h>

/* A comet without mass among the Sun, Jupiter, Saturn, Uranus and Neptune, which move on circles in a plane: lengths
 * in AU, G and the mass of the Sun 1, a year 2 pi. The comet, e = 0.952, passes the Sun at 0.29 at t = 52.9 and Jupiter
 * at 0.010 at t = 60, and leaves with e = 0.981. To t = 120. Its equations are those of a given field V(q, t), in which
 * H is that of the comet alone: in a Hamiltonian of all bodies the roundoff of H, where g depends on the comet, acts on
 * a momentum that is smaller than it (docs/adaptive.md). */
enum { PLANETS = 4, AXES = 3 };
static const double mass[PLANETS] = {9.548e-4, 2.859e-4, 4.366e-5, 5.151e-5};
static const double radius[PLANETS] = {5.203, 9.555, 19.22, 30.11}, phase[PLANETS] = {0, 2, 4, 5};

/* The squares of the distances from the planets and the Sun, which holds the centre of mass at 0. */
static void squares(const jet q[], jet t, jet square[PLANETS + 1])
{
    jet sun[2] = {jet_const(0), jet_const(0)};
    for (int k = 0; k <= PLANETS; k++) {
        jet at[2] = {sun[0], sun[1]};
        if (k < PLANETS) {
            const jet angle = jet_add(jet_mul(sqrt((1 + mass[k]) / pow(radius[k], 3)), t), phase[k]);
            at[0] = jet_mul(radius[k], jet_cos(angle)), at[1] = jet_mul(radius[k], jet_sin(angle));
            for (int i = 0; i < 2; i++) sun[i] = jet_sub(sun[i], jet_mul(mass[k], at[i]));
        }
        const jet d[AXES] = {jet_sub(q[0], at[0]), jet_sub(q[1], at[1]), q[2]};
        square[k] = jet_dot(d, d, AXES);
    }
}

/* sum m_k |q - q_k|^exponent */
static jet weighted(const jet q[], jet t, double exponent)
{
    jet term[PLANETS + 1];
    squares(q, t, term);
    for (int k = 0; k <= PLANETS; k++) term[k] = jet_mul(k < PLANETS ? mass[k] : 1, jet_pow(term[k], exponent / 2));
    return jet_sum(term, PLANETS + 1);
}

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    return jet_neg(weighted(q, t, -1));
}

/* g = (sum m_k / r_k^3)^(-1/2) */
static jet scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)ctx;
    return jet_pow(weighted(q, t, -3), -0.5);
}

const hard_scene hard_comet = {
    .scene = {.name = "comet",
              .title = "A comet that passes Sun and Jupiter",
              .n = AXES,
              .potential = potential,
              .q = (const double[]){5.591423, -9.934218, 3.457256},
              .p = (const double[]){0.03578012, 0.001665258, 0.06234636},
              .t_end = 120,
              .energy_scale = 0.08,
              .reference = reference_comet},
    .scale = scale,
};
