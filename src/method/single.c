/* single.c - Makes the step of one member of a batch by the stepper's own step (single.h). */
#include "method/single.h"

void tvi_single_take(tvi_single *single, tvi_arena *arena, const tvi_stepper *stepper, const tvi_system *system,
                     const tvi_options *options, int width, int points)
{
    const tvi_block *const others = arena->blocks;
    const int slots[] = {system->field_values->slots, system->field_series->slots};
    *single = (tvi_single){.stepper = stepper, .system = system, .width = width};
    arena->blocks = NULL;
    single->work = stepper->take(arena, system, options);
    single->blocks = arena->blocks;
    arena->blocks = others;
    single->parameters = tvi_arena_doubles(arena, (size_t)tvi_system_parameters(system));
    tvi_increments *increments = &single->increments;
    double **const vectors[] = {&single->q,      &single->q_low,  &single->p,          &single->p_low,
                                &increments->dq, &increments->dp, &increments->dq_low, &increments->dp_low};
    for (size_t i = 0; i < 8; i++) *vectors[i] = tvi_arena_doubles(arena, (size_t)system->n);
    single->block = tvi_arena_doubles(arena, (size_t)(slots[0] > slots[1] ? slots[0] : slots[1]) * (size_t)points);
}

void tvi_single_prepare(tvi_single *single)
{
    tvi_system_prepare(single->system, single->blocks, NULL);
    if (single->stepper->prepare) single->stepper->prepare(single->work);
}

void tvi_gather(int rows, int width, const double *from, int member, double to[])
{
    for (int i = 0; i < rows; i++) to[i] = from[(size_t)i * (size_t)width + (size_t)member];
}

void tvi_scatter(int rows, int width, const double from[], int member, double *to)
{
    for (int i = 0; i < rows; i++) to[(size_t)i * (size_t)width + (size_t)member] = from[i];
}

bool tvi_single_is_inside(const tvi_single *single, const jet_tape *tape, const double *x, int points, int member)
{
    tvi_gather(tape->slots * points, single->width, x, member, single->block);
    return tape->sweeps->values(tape, single->block, points);
}

bool tvi_single_step(const tvi_single *single, const jet_tape *tape, const double *x, int points, double h,
                     const tvi_batch_origin *origin, const tvi_batch_end *end, int member, tvi_stats *stats)
{
    const int n = single->system->n, width = single->width;
    const tvi_origin from = {origin->t[member], origin->t_low[member], single->q, single->q_low,
                             single->p,         single->p_low};
    const long passes = stats->passes;
    tvi_gather(n, width, origin->q, member, single->q);
    tvi_gather(n, width, origin->q_low, member, single->q_low);
    tvi_gather(n, width, origin->p, member, single->p);
    tvi_gather(n, width, origin->p_low, member, single->p_low);
    jet_tape_read_parameters(tape, x, points * width, member, single->parameters);
    tvi_blocks_set_parameters(single->blocks, tvi_system_parameters(single->system), 1, single->parameters);
    end->status[member] = single->stepper->step(single->work, h, &from, &single->increments, stats);
    if (end->status[member] != TVI_OK) return false;
    tvi_scatter(n, width, single->increments.dq, member, end->increments.dq);
    tvi_scatter(n, width, single->increments.dp, member, end->increments.dp);
    tvi_scatter(n, width, single->increments.dq_low, member, end->increments.dq_low);
    tvi_scatter(n, width, single->increments.dp_low, member, end->increments.dp_low);
    end->tail[member] = stats->tail;
    end->passes[member] = (int)(stats->passes - passes);
    return true;
}
