/* hard.h - Declares scenes that no fixed step is good at, each with a time scale for tvi_system_rescaled. They are not
 * among the scenes of the sweeps. */
#ifndef HARD_H
#define HARD_H

#include "scene.h"

typedef struct {
    scene scene; /* no steps; reference NULL: Kepler from pericentre at (q[0], 0), which has a closed form */
    tvi_rescale_fn *scale;
} hard_scene;

extern const hard_scene hard_kepler_90, hard_kepler_99, hard_kepler_999, hard_pythagorean, hard_comet, hard_sitnikov,
    hard_three_planets;
extern const hard_scene *const hard_scenes[]; /* all of them; NULL ends */

/* Kepler's equation: the E with E - e sin E = M, -pi <= E <= pi, M taken modulo a turn. */
long double kepler_anomaly(long double e, long double M);

#endif
