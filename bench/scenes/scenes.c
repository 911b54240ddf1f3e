/* scenes.c - Lists the scenes, and finds one by its name. */
#include "hard.h"

#include <string.h>

const scene *const scenes[] = {
    &scene_pendulum, &scene_kepler, &scene_henon_heiles_12, &scene_henon_heiles_8, &scene_fpu, &scene_solar, NULL,
};

const scene *const general_scenes[] = {
    &scene_double_pendulum, &scene_magnetic, &scene_nonseparable, &scene_vortices, &scene_degenerate, NULL,
};

const hard_scene *const hard_scenes[] = {
    &hard_kepler_90, &hard_kepler_99, &hard_kepler_999,    &hard_pythagorean,
    &hard_comet,     &hard_sitnikov,  &hard_three_planets, NULL,
};

const scene *scene_find(const char *name)
{
    for (const scene *const *s = scenes; *s; s++)
        if (strcmp((*s)->name, name) == 0) return *s;
    return NULL;
}

tvi_status scene_system(const scene *s, tvi_system **out)
{
    if (s->lagrangian) return tvi_system_lagrangian(out, s->n, s->lagrangian, NULL);
    if (s->hamiltonian) return tvi_system_hamiltonian(out, s->n, s->hamiltonian, NULL);
    return tvi_system_potential(out, s->n, s->mass, s->potential, NULL);
}
