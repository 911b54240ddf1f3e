/* curves.c - Opens a curve of the library outside of an integrator (curves.h). */
#include "curves.h"

#include "experiments/experiment.h"

#include <stdlib.h>

static void lay_out(open_curve *c, tvi_arena *arena, const tvi_system *system, int N)
{
    tvi_curve_allocate(&c->curve, arena, system, N, TVI_JACOBIAN_PRODUCTS);
    c->z = tvi_arena_allocate_doubles(arena, 2 * (size_t)system->n);
}

open_curve *curve_open(const tvi_system *system, int N, const double q[], const double p[], double h)
{
    open_curve *c = calloc(1, sizeof *c);
    if (!c) abort();
    tvi_arena arena = {0};
    lay_out(c, &arena, system, N);
    c->memory = tvi_arena_obtain_memory(&arena);
    if (!c->memory) abort();
    lay_out(c, &arena, system, N);
    tvi_blocks_set_constants(arena.first_tape_block);
    tvi_curve_fill_tables(&c->curve);
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
    curve_set_tau(&c->curve, c->tau);
    curve_set_z(&c->curve, c->z);
    experiment_insist(tvi_curve_expand(&c->curve, 0), "an expansion");
}
