/* three_planets.c - Defines the scene of three planets with a close encounter. */
#include "gravity.h"
#include "hard.h"
#include "references.h"

/* Three planets too close to each other: a = 1, 1.18, 1.42, masses 1e-3 of the star's, on circles at phases 0, 1 and 3.
 * The inner two pass each other at 0.0011 at t = 5.07. To t = 30; the motion is chaotic. */
static const double mass[] = {1, 1e-3, 1e-3, 1e-3};
GRAVITY_OF(mass, 2, 3)

const hard_scene hard_three_planets = {
    .scene = {.name = "three_planets",
              .title = "Three planets with a close encounter",
              .n = 2 * BODIES,
              .mass = (const double[]){1, 1, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3},
              .potential = potential,
              .q = (const double[]){0, 0, 1, 0, 0.637556721, 0.992935762, -1.40578935, 0.200390411},
              .p = (const double[]){0, 0, 0, 1e-3, -0.77463683e-3, 0.497388589e-3, -0.11842528e-3, -0.830783248e-3},
              .t_end = 30,
              .energy_scale = 1.3e-3,
              .reference = reference_three_planets},
    .scale = scale,
};
