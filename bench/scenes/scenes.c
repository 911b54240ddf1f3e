#include "scene.h"

#include <string.h>

const scene *const scenes[] = {
    &scene_pendulum, &scene_kepler, &scene_henon_heiles_12, &scene_henon_heiles_8, &scene_fpu, &scene_solar, NULL,
};

const scene *scene_find(const char *name)
{
    for (const scene *const *s = scenes; *s; s++)
        if (strcmp((*s)->name, name) == 0) return *s;
    return NULL;
}
