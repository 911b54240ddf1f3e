/* tvi.c - runs the default method of this library, from the tape and with generated code. Steps that have
 * to adapt are those of tvi_system_rescaled. */
#include "peer.h"
#include "scenes/hard.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TAPE, COMPILED };

typedef struct {
    const problem *problem;
    double h;
    tvi_system *system, *rescaled;
    tvi_compiled *code;
    tvi_integrator *integrator;
} own_run;

static const double *settings(const peer *self, const problem *p)
{
    (void)self;
    return p->steps;
}

static void close_run(void *run)
{
    own_run *r = run;
    tvi_integrator_free(r->integrator);
    tvi_compiled_free(r->code);
    tvi_system_free(r->rescaled);
    tvi_system_free(r->system);
    free(r);
}

static tvi_status make_run(own_run *r, bool is_compiled)
{
    char cache[4096];
    tvi_options options = tvi_options_default();
    const hard_scene *hard = r->problem->hard;
    tvi_status status = scene_system(r->problem->scene, &r->system);
    if (status == TVI_OK && hard) status = tvi_system_rescaled(&r->rescaled, r->system, hard->scale, NULL);
    const tvi_system *system = r->rescaled ? r->rescaled : r->system;
    snprintf(cache, sizeof cache, "%s/generated", peers_folder);
    if (status == TVI_OK && is_compiled)
        status = tvi_compile(&r->code, system, &options, &(tvi_compiler){.cache = cache});
    options.compiled = r->code;
    return status == TVI_OK ? tvi_integrator_create(&r->integrator, system, &options) : status;
}

static void *open_run(const peer *self, const problem *p, double setting)
{
    own_run *r = malloc(sizeof *r);
    if (!r) return NULL;
    *r = (own_run){.problem = p, .h = setting};
    if (make_run(r, self->variant == COMPILED) == TVI_OK) return r;
    close_run(r);
    return NULL;
}

static bool go(void *run, double q[])
{
    const own_run *r = run;
    const scene *s = r->problem->scene;
    double t = 0, p[PEER_N_MAX];
    memcpy(q, s->q, (size_t)s->n * sizeof *q);
    memcpy(p, s->p, (size_t)s->n * sizeof *p);
    return tvi_integrate_to(r->integrator, r->h, s->t_end, &t, q, p, NULL, NULL) == TVI_OK;
}

#define PEER(...)                                                                                                      \
    {                                                                                                                  \
        __VA_ARGS__, settings, open_run, go, close_run                                                                 \
    }
static const peer peers[] = {PEER("tvi, tape", TAPE), PEER("tvi, compiled", COMPILED), {.name = NULL}};

const peer_program peers_of_tvi = {"tvi", tvi_version, peers};
