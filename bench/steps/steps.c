/* steps.c - Makes steps of a scene for a profiler to look at: ten to begin with, then ten in measured_steps.
 *
 *   steps SCENE METHOD ORDER H */
#include "scenes/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST = 10, MEASURED = 10, MOST = 64 }; /* steps; coordinates */

typedef struct {
    tvi_integrator *integrator;
    double h, t, q[MOST], p[MOST];
} state;

static tvi_status make_steps(state *x, int count)
{
    tvi_status status = TVI_OK;
    for (int i = 0; i < count && status == TVI_OK; i++) status = tvi_step(x->integrator, x->h, &x->t, x->q, x->p);
    return status;
}

/* The function that callgrind --toggle-collect counts. */
__attribute__((noinline)) tvi_status measured_steps(state *x);
tvi_status measured_steps(state *x) { return make_steps(x, MEASURED); }

static tvi_status run(const scene *s, const tvi_options *options, double h)
{
    tvi_system *system;
    state x = {.h = h};
    memcpy(x.q, s->q, (size_t)s->n * sizeof *x.q);
    memcpy(x.p, s->p, (size_t)s->n * sizeof *x.p);
    tvi_status status = scene_system(s, &system);
    if (status == TVI_OK) status = tvi_integrator_create(&x.integrator, system, options);
    if (status == TVI_OK) status = make_steps(&x, FIRST);
    if (status == TVI_OK) status = measured_steps(&x);
    tvi_integrator_free(x.integrator);
    tvi_system_free(system);
    return status;
}

static const scene *find(const char *name)
{
    const scene *s = scene_find(name);
    for (const scene *const *general = general_scenes; !s && *general; general++)
        if (strcmp((*general)->name, name) == 0) s = *general;
    return s;
}

int main(int argc, char *argv[])
{
    tvi_options options;
    const scene *s = argc == 5 ? find(argv[1]) : NULL;
    if (!s || tvi_options_named(argv[2], atoi(argv[3]), &options) != TVI_OK) {
        fprintf(stderr, "usage: steps SCENE METHOD ORDER H\n");
        return EXIT_FAILURE;
    }
    const tvi_status status = run(s, &options, strtod(argv[4], NULL));
    if (status != TVI_OK) fprintf(stderr, "steps: %s: %s\n", s->name, tvi_status_string(status));
    return status == TVI_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
