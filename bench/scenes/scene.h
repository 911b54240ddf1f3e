/* scene.h - the problems of the bench and the tests: a potential, a start, an end, and where the exact solution is then. */
#ifndef SCENE_H
#define SCENE_H

#include "tvi.h"

typedef struct {
    const char *name, *title;
    const char *time_unit;       /* of h and t; "" where the problem has no unit */
    int n;
    const double *mass;          /* [n], NULL = all 1 */
    tvi_potential_fn *potential; /* V; the scene's force is derived from it */
    const double *q, *p;         /* [n] the start at t = 0 */
    double t_end;
    double energy_scale;         /* the energy error is relative to max(|H0|, this) */
    const double *reference;     /* [2n] q then p at t_end, converged to 25 digits, rounded to double */
    const double *steps;         /* the h of a sweep, descending, 0 ends; t_end/h steps of h end at t_end exactly */
} scene;

extern const scene scene_pendulum, scene_kepler, scene_henon_heiles_12, scene_henon_heiles_8, scene_fpu, scene_solar;

extern const scene *const scenes[];         /* all of them, the cheapest first; NULL ends */
const scene *scene_find(const char *name);  /* NULL: no such scene */

#endif
