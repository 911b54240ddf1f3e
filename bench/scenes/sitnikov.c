/* sitnikov.c - Defines the scene of Sitnikov's problem. */
#include "hard.h"
#include "references.h"

/* Sitnikov's problem: a particle without mass on the axis through the centre of two equal masses, whose distance is
 * rho = (1 - e^2)/(1 + e cos f), e = 0.6. The time is f, their true anomaly, and q = z/rho (Szebehely, Theory of
 * Orbits, 10.3, on the axis):
 *     q'' = -(e cos f + (q^2 + 1/4)^(-3/2)) q / (1 + e cos f).
 * A regular orbit, 50 revolutions. */
enum { REVOLUTIONS = 50 };
static const double e = 0.6;

static jet potential(const jet q[], jet t, void *ctx)
{
    const jet bend = jet_mul(e, jet_cos(t)), square = jet_sqr(q[0]);
    (void)ctx;
    return jet_div(jet_sub(jet_mul(0.5, jet_mul(bend, square)), jet_pow(jet_add(square, 0.25), -0.5)),
                   jet_add(1, bend));
}

/* 1 / the frequency of small motions at the same place; short where the force is strong. */
static jet scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)ctx;
    const jet strength = jet_pow(jet_add(jet_sqr(q[0]), 0.25), -1.5);
    return jet_sqrt(jet_div(jet_add(1, jet_mul(e, jet_cos(t))), strength));
}

const hard_scene hard_sitnikov = {
    .scene = {.name = "sitnikov",
              .title = "Sitnikov, e = 0.6",
              .n = 1,
              .potential = potential,
              .q = (const double[]){0.5},
              .p = (const double[]){0},
              .t_end = 314.159265358979324,
              .energy_scale = 1,
              .reference = reference_sitnikov},
    .scale = scale,
};
