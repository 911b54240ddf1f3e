/* scene.h - Declares the problems of the bench and the tests: a potential, a Lagrangian or a Hamiltonian, a start, an
 * end, and where the exact solution is then. */
#ifndef SCENE_H
#define SCENE_H

#include "tvi.h"

typedef struct {
    const char *name, *title;
    const char *time_unit; /* of h and t; "" where the problem has no unit */
    int n;
    const double *mass;          /* [n], NULL = all 1; of a potential only */
    tvi_potential_fn *potential; /* V; the scene's force is derived from it */
    tvi_lagrangian_fn *lagrangian;
    tvi_hamiltonian_fn *hamiltonian; /* exactly one of the three is not NULL */
    const double *q, *p;             /* [n] the start at t = 0 */
    double t_end;
    double energy_scale;     /* the energy error is relative to max(|H0|, this) */
    const double *reference; /* [2n] q then p at t_end, converged to 25 digits, rounded to double */
    const double *steps;     /* the h of a sweep, descending, 0 ends; t_end/h steps of h end at t_end exactly */
} scene;

extern const scene scene_pendulum, scene_kepler, scene_henon_heiles_12, scene_henon_heiles_8, scene_fpu, scene_solar;

extern const scene scene_planets; /* a scene of bench/peers */
/* Properties that a potential does not state: a mass that is no constant diagonal, velocities in the force, no mass at
 * all. */
extern const scene scene_double_pendulum, scene_magnetic, scene_nonseparable, scene_vortices, scene_degenerate;

extern const scene *const scenes[]; /* those with a potential, for the order sweeps: the cheapest first; NULL ends */
extern const scene *const general_scenes[]; /* the others; NULL ends */
const scene *scene_find(const char *name);  /* among scenes; NULL: no such scene */

/* The Lagrangian of two masses 1 and m on links of length 1, with the parameters g = 9.8 and m = 1. */
jet double_pendulum_with_parameters(const jet q[], const jet v[], jet t, void *ctx);

/* The scene's system; *out is NULL on failure. */
TVI_NODISCARD tvi_status scene_system(const scene *s, tvi_system **out);

#endif
