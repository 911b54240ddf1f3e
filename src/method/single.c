/* single.c - Makes the step of one member of a batch, which is a group of members of an ensemble that are stepped
 * together (single.h). */
#include "method/single.h"

void tvi_allocate_state_and_increments(tvi_arena *arena, int n, tvi_run_state *state, tvi_increments *increments)
{
    double **const vectors[] = {&state->q,       &state->q_low,   &state->p,           &state->p_low,
                                &increments->dq, &increments->dp, &increments->dq_low, &increments->dp_low};
    for (size_t i = 0; i < 8; i++) *vectors[i] = tvi_arena_allocate_doubles(arena, (size_t)n);
}

void tvi_member_stepper_allocate(tvi_member_stepper *member_stepper, tvi_arena *arena, const tvi_stepper *stepper,
                                 const tvi_system *system, const tvi_options *options, int width, int point_count)
{
    const tvi_tape_block *const blocks_of_batch = arena->first_tape_block;
    const int slots[] = {system->field_values->slot_count, system->field_series->slot_count};
    *member_stepper = (tvi_member_stepper){.stepper = stepper, .system = system, .batch_width = width};
    arena->first_tape_block = NULL;
    member_stepper->stepper_work = stepper->allocate(arena, system, options);
    member_stepper->tape_block_list_of_stepper = arena->first_tape_block;
    arena->first_tape_block = blocks_of_batch;
    member_stepper->parameters = tvi_arena_allocate_doubles(arena, (size_t)tvi_system_parameters(system));
    tvi_allocate_state_and_increments(arena, system->n, &member_stepper->start_state, &member_stepper->increments);
    member_stepper->member_block =
        tvi_arena_allocate_doubles(arena, (size_t)(slots[0] > slots[1] ? slots[0] : slots[1]) * (size_t)point_count);
}

void tvi_member_stepper_set_tables(tvi_member_stepper *member_stepper)
{
    tvi_system_prepare_blocks(member_stepper->system, member_stepper->tape_block_list_of_stepper, NULL);
    if (member_stepper->stepper->set_tables) member_stepper->stepper->set_tables(member_stepper->stepper_work);
}

void tvi_gather_member(int rows, int width, const double *from, int member, double to[])
{
    for (int i = 0; i < rows; i++) to[i] = from[(size_t)i * (size_t)width + (size_t)member];
}

void tvi_scatter_member(int rows, int width, const double from[], int member, double *to)
{
    for (int i = 0; i < rows; i++) to[(size_t)i * (size_t)width + (size_t)member] = from[i];
}

bool tvi_is_member_inside_domain(const tvi_member_stepper *member_stepper, const jet_tape *tape,
                                 const double *batch_block, int point_count, int member)
{
    tvi_gather_member(tape->slot_count * point_count, member_stepper->batch_width, batch_block, member,
                      member_stepper->member_block);
    return tape->sweeps->values(tape, member_stepper->member_block, point_count);
}

bool tvi_step_member(const tvi_member_stepper *member_stepper, const jet_tape *tape, const double *batch_block,
                     int point_count, double h, const tvi_batch_origin *origin, const tvi_batch_results *results,
                     int member, tvi_stats *stats)
{
    const int n = member_stepper->system->n, width = member_stepper->batch_width;
    const tvi_run_state *state = &member_stepper->start_state;
    const tvi_step_origin from = {origin->t[member], origin->t_low[member], state->q, state->q_low,
                                  state->p,          state->p_low};
    const long passes = stats->passes;
    tvi_gather_member(n, width, origin->q, member, state->q);
    tvi_gather_member(n, width, origin->q_low, member, state->q_low);
    tvi_gather_member(n, width, origin->p, member, state->p);
    tvi_gather_member(n, width, origin->p_low, member, state->p_low);
    jet_tape_read_parameters(tape, batch_block, point_count * width, member, member_stepper->parameters);
    tvi_blocks_set_parameters(member_stepper->tape_block_list_of_stepper, tvi_system_parameters(member_stepper->system),
                              1, member_stepper->parameters);
    results->status[member] =
        member_stepper->stepper->step(member_stepper->stepper_work, h, &from, &member_stepper->increments, stats);
    if (results->status[member] != TVI_OK) return false;
    tvi_scatter_member(n, width, member_stepper->increments.dq, member, results->increments.dq);
    tvi_scatter_member(n, width, member_stepper->increments.dp, member, results->increments.dp);
    tvi_scatter_member(n, width, member_stepper->increments.dq_low, member, results->increments.dq_low);
    tvi_scatter_member(n, width, member_stepper->increments.dp_low, member, results->increments.dp_low);
    results->tail[member] = stats->tail;
    results->pass_counts[member] = (int)(stats->passes - passes);
    return true;
}
