/* forces.h - Declares the scenes' forces by hand. FORCES_BY_HAND calls F(name, n) once for each, in the order of
 * force_id. */
#ifndef FORCES_H
#define FORCES_H

#include "baseline.h"

#include <math.h>

#define FORCES_BY_HAND(F) F(pendulum, 1) F(kepler, 2) F(henon_heiles, 2) F(fpu, 6) F(solar, 18)
typedef enum {
    FORCE_PENDULUM,
    FORCE_KEPLER,
    FORCE_HENON_HEILES,
    FORCE_FPU,
    FORCE_SOLAR,
    FORCES,
    FORCE_NONE = FORCES
} force_id;

force_id force_of(const scene *s);

/* The accelerations of one point. */
typedef void acceleration_fn(const double *q, double *a);
extern acceleration_fn *const accelerations[FORCES];

static const double PENDULUM_G = 9.8, FPU_W = 50, SOLAR_G = 2.95912208286e-4;
static const double SOLAR_MASS[6] = {1.00000597682,      0.000954786104043,  0.000285583733151,
                                     0.0000437273164546, 0.0000517759138449, 1 / 1.3e8};

#endif
