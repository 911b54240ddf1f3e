#include "curves.h"

#include "experiments/experiment.h"

#include <stdlib.h>
#include <string.h>

/* Type I at the midpoint of degree N, resolved. */
static tvi_options resolved_options(const tvi_system *system, int N)
{
    tvi_options options;
    tvi_integrator *integrator;
    experiment_insist(tvi_options_named("midpoint", 2 * N, &options), "midpoint");
    experiment_insist(tvi_integrator_create(&integrator, system, &options), "midpoint");
    options = *tvi_integrator_options(integrator);
    tvi_integrator_free(integrator);
    return options;
}

static void lay_out(open_curve *c, tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    const int N = options->degree;
    const size_t n = (size_t)system->n, seeds = ((size_t)N + 1) * n;
    tvi_curve_take(&c->curve, arena, system, N, TVI_JACOBIAN_PRODUCTS);
    tvi_action_take(&c->action, arena, system, options, TVI_ACTION_LAGRANGE, N, N - 1, N, true);
    c->seed_Q = tvi_arena_doubles(arena, seeds);
    c->seed_U = tvi_arena_doubles(arena, seeds);
    c->D = tvi_arena_doubles(arena, 2 * n);
    c->z = tvi_arena_doubles(arena, 2 * n);
}

open_curve *curve_open(const tvi_system *system, int N, const double q[], const double p[], double h)
{
    const tvi_options options = resolved_options(system, N);
    open_curve *c = calloc(1, sizeof *c);
    if (!c) abort();
    tvi_arena arena = {0};
    lay_out(c, &arena, system, &options);
    c->memory = tvi_arena_open(&arena);
    if (!c->memory) abort();
    lay_out(c, &arena, system, &options);
    tvi_blocks_prepare(arena.blocks);
    tvi_curve_prepare(&c->curve);
    tvi_action_prepare(&c->action, &options, (tvi_span){-1, 1, 0.5}, N);
    c->tau = h / 2;
    for (int i = 0; i < system->n; i++) {
        c->z[i] = q[i];
        c->z[system->n + i] = c->tau * p[i] / system->mass[i];
    }
    curve_expand(c);
    return c;
}

void curve_close(open_curve *c)
{
    free(c->memory);
    free(c);
}

void curve_expand(void *opened)
{
    open_curve *c = opened;
    tvi_curve_set(&c->curve, c->tau, c->z);
    experiment_insist(tvi_curve_expand(&c->curve, 0), "an expansion");
}

void curve_pull(void *opened)
{
    open_curve *c = opened;
    tvi_curve_pull(&c->curve, c->seed_Q, c->seed_U, c->D);
}

void curve_gradient(void *opened)
{
    open_curve *c = opened;
    experiment_insist(tvi_action_seed(&c->action, &c->curve, c->seed_Q, c->seed_U), "a gradient");
    curve_pull(c);
}
