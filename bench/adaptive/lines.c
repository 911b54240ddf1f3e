/* lines.c - Lists the rows of the table and the curves of the picture of docs/adaptive.md. */
#include "adaptive.h"

#define FIXED     .method = "galerkin", .order = 16, .g = ADAPTIVE_FIXED
#define OWN       .method = "galerkin", .order = 16, .g = ADAPTIVE_OWN
#define AUTOMATIC .method = "galerkin", .order = 16, .g = ADAPTIVE_AUTOMATIC
#define POINCARE  .method = "poincare", .order = 20, .g = ADAPTIVE_OWN
#define TOLERANCE .method = "taylor", .order = 18, .g = ADAPTIVE_TOLERANCE, .h = 1e-14

/* With the automatic g a revolution is 5^(1/4) times as long. */
#define S_90   ADAPTIVE_S_90
#define S_99   ADAPTIVE_S_99
#define ROOT_5 1.4953487812212205 /* 5^(1/4) */

const adaptive_line adaptive_lines[] = {
    {&hard_kepler_90, FIXED, .h = ADAPTIVE_REVOLUTION / 100},
    {&hard_kepler_90, FIXED, .h = ADAPTIVE_REVOLUTION / 800},
    {&hard_kepler_90, OWN, .h = S_90 / 10},
    {&hard_kepler_90, AUTOMATIC, .h = ROOT_5 * S_90 / 10},
    {&hard_kepler_90, POINCARE, .h = S_90 / 15},
    {&hard_kepler_90, TOLERANCE},
    {&hard_kepler_99, FIXED, .h = ADAPTIVE_REVOLUTION / 800},
    {&hard_kepler_99, FIXED, .h = ADAPTIVE_REVOLUTION / 6400},
    {&hard_kepler_99, OWN, .h = S_99 / 10},
    {&hard_kepler_99, AUTOMATIC, .h = ROOT_5 * S_99 / 10},
    {&hard_kepler_99, POINCARE, .h = S_99 / 15},
    {&hard_kepler_99, TOLERANCE},
    {&hard_pythagorean, FIXED, .h = 1e-3},
    {&hard_pythagorean, FIXED, .h = 1e-4},
    {&hard_pythagorean, OWN, .h = 0.9},
    {&hard_pythagorean, AUTOMATIC, .h = 0.3},
    {&hard_pythagorean, POINCARE, .h = 0.6},
    {&hard_pythagorean, TOLERANCE},
    {&hard_comet, FIXED, .h = 120.0 / 6400},
    {&hard_comet, OWN, .h = 0.06},
    {&hard_comet, AUTOMATIC, .h = 0.08},
    {&hard_comet, TOLERANCE},
    {&hard_sitnikov, FIXED, .h = ADAPTIVE_REVOLUTION / 40},
    {&hard_sitnikov, OWN, .h = 0.7},
    {&hard_sitnikov, TOLERANCE},
    {&hard_three_planets, FIXED, .h = 30.0 / 6400},
    {&hard_three_planets, OWN, .h = 0.5},
    {&hard_three_planets, AUTOMATIC, .h = 0.5},
    {&hard_three_planets, TOLERANCE},
    {.problem = NULL},
};

const adaptive_line adaptive_errors[] = {
    {&hard_kepler_90, FIXED, .h = ADAPTIVE_REVOLUTION / 100},
    {&hard_kepler_90, FIXED, .h = ADAPTIVE_REVOLUTION / 800},
    {&hard_kepler_90, OWN, .h = S_90 / 10},
    {&hard_kepler_99, FIXED, .h = ADAPTIVE_REVOLUTION / 6400},
    {&hard_kepler_99, OWN, .h = S_99 / 10},
    {&hard_kepler_90, TOLERANCE},
    {&hard_kepler_99, TOLERANCE},
    {.problem = NULL},
};

const adaptive_line adaptive_steps[] = {
    {&hard_pythagorean, OWN, .h = 0.9},
    {&hard_pythagorean, AUTOMATIC, .h = 0.3},
    {.problem = NULL},
};
