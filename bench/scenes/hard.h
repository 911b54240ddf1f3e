/* hard.h - scenes that no fixed step is good at, each with a time scale for tvi_system_rescaled. They are not
 * among the scenes of the sweeps. */
#ifndef HARD_H
#define HARD_H

#include "scene.h"

typedef struct {
    scene scene; /* no steps; no reference, but: */
    tvi_rescale_fn *scale;
    const double *q_end; /* [2] q[0] and q[1] at t_end; NULL: Kepler from pericentre at (q[0], 0), which has a closed
                            form */
} hard_scene;

extern const hard_scene hard_kepler_90, hard_kepler_99, hard_kepler_999, hard_pythagorean;

#endif
