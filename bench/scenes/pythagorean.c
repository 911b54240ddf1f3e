/* pythagorean.c - Defines the scene of the Pythagorean three bodies. */
#include "gravity.h"
#include "hard.h"
#include "references.h"

/* Burrau's problem: masses 3, 4, 5 at rest in the corners opposite to the sides 3, 4, 5 of a triangle. The closest of
 * its encounters is at 4.1e-4; at t = 60 the lightest body leaves. To t = 70. */
static const double mass[] = {3, 4, 5};
GRAVITY_OF(mass, 2, 1)

const hard_scene hard_pythagorean = {
    .scene = {.name = "pythagorean",
              .title = "Pythagorean three bodies",
              .n = 2 * BODIES,
              .mass = (const double[]){3, 3, 4, 4, 5, 5},
              .potential = potential,
              .q = (const double[]){1, 3, -2, -1, 1, -1},
              .p = (const double[]){0, 0, 0, 0, 0, 0},
              .t_end = 70,
              .energy_scale = 12.8,
              .reference = reference_pythagorean},
    .scale = scale,
};
