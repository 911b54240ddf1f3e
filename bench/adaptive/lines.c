/* lines.c - the rows of the table and the curves of the picture of docs/adaptive.md. */
#include "adaptive.h"

#define FIXED     .method = "galerkin", .order = 16, .g = ADAPTIVE_FIXED
#define OWN       .method = "galerkin", .order = 16, .g = ADAPTIVE_OWN
#define AUTOMATIC .method = "galerkin", .order = 16, .g = ADAPTIVE_AUTOMATIC
#define POINCARE  .method = "poincare", .order = 20, .g = ADAPTIVE_OWN
#define RIGHT     .method = "right", .order = 12, .g = ADAPTIVE_OWN
#define TOLERANCE .method = "taylor", .order = 18, .g = ADAPTIVE_TOLERANCE, .h = 1e-14
#define TIMED     .is_timed = true

#define TWO_PI 6.2831853071795864769

/* With the automatic g a revolution is 5^(1/4) times as long. */
#define S_90   ADAPTIVE_S_90
#define S_99   ADAPTIVE_S_99
#define S_999  ADAPTIVE_S_999
#define ROOT_5 1.4953487812212205 /* 5^(1/4) */

const adaptive_line adaptive_lines[] = {
    {&hard_kepler_90, FIXED, .h = TWO_PI / 100, TIMED},
    {&hard_kepler_90, FIXED, .h = TWO_PI / 800, TIMED},
    {&hard_kepler_90, OWN, .h = S_90 / 10, TIMED},
    {&hard_kepler_90, AUTOMATIC, .h = ROOT_5 * S_90 / 10, TIMED},
    {&hard_kepler_90, POINCARE, .h = S_90 / 15, TIMED},
    {&hard_kepler_90, RIGHT, .h = S_90 / 73, TIMED},
    {&hard_kepler_90, TOLERANCE, TIMED},
    {&hard_kepler_90, OWN, .h = S_90 / 10, .lengths = 100},
    {&hard_kepler_99, FIXED, .h = TWO_PI / 800, TIMED},
    {&hard_kepler_99, FIXED, .h = TWO_PI / 6400, TIMED},
    {&hard_kepler_99, OWN, .h = S_99 / 10, TIMED},
    {&hard_kepler_99, OWN, .h = 1.1447, TIMED},
    {&hard_kepler_99, AUTOMATIC, .h = ROOT_5 * S_99 / 10, TIMED},
    {&hard_kepler_99, POINCARE, .h = S_99 / 15, TIMED},
    {&hard_kepler_99, RIGHT, .h = S_99 / 73, TIMED},
    {&hard_kepler_99, TOLERANCE, TIMED},
    {&hard_kepler_999, FIXED, .h = TWO_PI / 6400, TIMED},
    {&hard_kepler_999, OWN, .h = S_999 / 15, TIMED},
    {&hard_kepler_999, AUTOMATIC, .h = ROOT_5 * S_999 / 15, TIMED},
    {&hard_kepler_999, POINCARE, .h = S_999 / 20, TIMED},
    {&hard_kepler_999, RIGHT, .h = S_999 / 100, TIMED},
    {&hard_kepler_999, TOLERANCE, TIMED},
    {&hard_pythagorean, FIXED, .h = 1e-3, TIMED},
    {&hard_pythagorean, FIXED, .h = 1e-4, TIMED},
    {&hard_pythagorean, OWN, .h = 0.9, TIMED},
    {&hard_pythagorean, AUTOMATIC, .h = 0.3, TIMED},
    {&hard_pythagorean, POINCARE, .h = 0.6, TIMED},
    {&hard_pythagorean, RIGHT, .h = 0.1, TIMED},
    {&hard_pythagorean, TOLERANCE, TIMED},
    {&hard_comet, FIXED, .h = 120.0 / 6400, TIMED},
    {&hard_comet, OWN, .h = 0.06, TIMED},
    {&hard_comet, AUTOMATIC, .h = 0.08, TIMED},
    {&hard_comet, TOLERANCE, TIMED},
    {&hard_sitnikov, FIXED, .h = TWO_PI / 40, TIMED},
    {&hard_sitnikov, OWN, .h = 0.7, TIMED},
    {&hard_sitnikov, TOLERANCE, TIMED},
    {&hard_three_planets, FIXED, .h = 30.0 / 6400, TIMED},
    {&hard_three_planets, OWN, .h = 0.5, TIMED},
    {&hard_three_planets, AUTOMATIC, .h = 0.5, TIMED},
    {&hard_three_planets, TOLERANCE, TIMED},
    {.of = NULL},
};

const adaptive_line adaptive_errors[] = {
    {&hard_kepler_90, FIXED, .h = TWO_PI / 100},
    {&hard_kepler_90, FIXED, .h = TWO_PI / 800},
    {&hard_kepler_90, OWN, .h = S_90 / 10},
    {&hard_kepler_99, FIXED, .h = TWO_PI / 6400},
    {&hard_kepler_99, OWN, .h = S_99 / 10},
    {&hard_kepler_90, TOLERANCE},
    {&hard_kepler_99, TOLERANCE},
    {.of = NULL},
};

const adaptive_line adaptive_steps[] = {
    {&hard_pythagorean, OWN, .h = 0.9},
    {&hard_pythagorean, AUTOMATIC, .h = 0.3},
    {.of = NULL},
};
