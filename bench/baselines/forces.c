/* forces.c - Computes the scenes' forces by hand (forces.h). */
#include "forces.h"

#define LANES 1
#include "force_kernels.h"
#undef LANES

force_id force_of(const scene *s)
{
    static const scene *const scene_of[FORCES] = {&scene_pendulum, &scene_kepler, &scene_henon_heiles_12, &scene_fpu,
                                                  &scene_solar};
    int id = 0;
    while (id < FORCES && s->potential != scene_of[id]->potential) id++;
    return (force_id)id;
}

#define ACCELERATION(name, n)                                                                                          \
    static void name##_acceleration(const double *q, double *a) { name##_1(q, a); }
FORCES_BY_HAND(ACCELERATION)

#define ROW(name, n) name##_acceleration,
acceleration_fn *const accelerations[FORCES] = {FORCES_BY_HAND(ROW)};
