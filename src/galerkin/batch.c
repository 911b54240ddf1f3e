/* batch.c - Makes a step of the Galerkin curves of several members of an ensemble at once. The ensembles of src/run/
 * call these functions through tvi_stepper_galerkin.batch. Arrays of unknowns are [unknowns][node_count][member_count]:
 * number m + member_count i of a row belongs to node i of member m, and the tape of the field computes all of them in
 * one sweep. The members in lanes are those that make a step together: their last step had the same size and ended
 * where the new step begins. Each member has its own test of convergence: a member that has converged no longer moves,
 * while passes of other members go on. The stepper of a single curve (galerkin.c) makes all other steps, one member
 * after the other: the first step of a run, a step that fails in lanes, and one whose roundoff has to be measured. */
#include "compiled/code.h"
#include "galerkin/step.h"
#include "method/single.h"

typedef struct {
    tvi_member_stepper member_stepper;
    /* The stepper that makes the step of one member alone; its tables of coefficients also serve the steps of several
     * members. */
    galerkin_stepper *single_stepper;
    galerkin_nodes nodes;
    galerkin_tail_inputs tail_inputs;
    galerkin_step_inputs step_inputs;
    galerkin_batch_iteration iteration;
    /* [member_count] All bits of stepped_together_mask are set if the member takes this step together with others. All
     * bits of last_step_only_mask are set if its unknowns are predicted from its last step alone. */
    long long *stepped_together_mask, *last_step_only_mask;
    tvi_increments increments; /* [n][member_count] the increments of the state */
    double *tail_of_member;    /* [member_count] the tail of each member's step (tvi_stats.tail) */
    /* The next three arrays are the history, the memory that a step leaves to the next step. */
    galerkin_history *history; /* [member_count] the history of each member; its last_ring_index is not set */
    long *last_ring_index;     /* the index of the last step's impulses in impulse_ring, for all members */
    /* [unknowns][node_count][member_count] The impulses (galerkin_nodes) of the last two steps and of the next one. */
    double *impulse_ring[GALERKIN_RING_LENGTH];
} galerkin_batch_stepper;

/* ---- Memory and tables ------------------------------------------------------------------------------------------- */

static const galerkin_kernels *const *const kernel_tables[JET_ISA_COUNT] = {
    [jet_isa_base] = &tvi_galerkin_batch_kernels_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = &tvi_galerkin_batch_kernels_avx2,
    [jet_isa_avx512] = &tvi_galerkin_batch_kernels_avx512,
#endif
};

static int choose_batch_width(const tvi_system *system, const tvi_options *options)
{
    const int node_count = options->degree, bytes = system->field_values->slot_count * node_count * (int)sizeof(double);
    if (system->hessian_values || options->passes == TVI_PREDICT_ONLY) return 1;
    const bool has_steps = system->code && system->code->galerkin;
    if (BATCH_MIN_WIDTH * bytes > (has_steps ? GALERKIN_BATCH_MAX_BYTES : GALERKIN_BATCH_MAX_BYTES_AT_MIN_WIDTH))
        return 1;
    int member_count = BATCH_MIN_WIDTH;
    while (2 * member_count <= BATCH_MAX_WIDTH && 2 * member_count * node_count <= GALERKIN_BATCH_MAX_LANES &&
           2 * member_count * bytes <= GALERKIN_BATCH_MAX_BYTES)
        member_count *= 2;
    return member_count;
}

static void allocate_node_arrays(galerkin_nodes *nodes, tvi_arena *arena, const tvi_system *system, int node_count,
                                 int member_count)
{
    const size_t row_arrays = (size_t)system->input_count * (size_t)member_count,
                 impulse_count = row_arrays * (size_t)node_count;
    *nodes = (galerkin_nodes){.unknown_count = system->input_count,
                              .coordinate_unknown_count = system->n,
                              .node_count = node_count,
                              .member_count = member_count};
    nodes->values = tvi_arena_allocate_block(arena, system->field_values, 1, node_count * member_count, 0);
    nodes->start_values = tvi_arena_allocate_doubles(arena, row_arrays);
    nodes->drift_values = tvi_arena_allocate_doubles(arena, impulse_count);
    nodes->drift_values_low = tvi_arena_allocate_doubles(arena, impulse_count);
    nodes->inverse_unknown_size = tvi_arena_allocate_doubles(arena, row_arrays);
}

static void *allocate_batch_stepper(tvi_arena *arena, const tvi_system *system, const tvi_options *options,
                                    int member_count)
{
    galerkin_batch_stepper *taken = tvi_arena_allocate(arena, sizeof *taken);
    galerkin_batch_stepper stepper = {.last_ring_index = NULL};
    tvi_member_stepper_allocate(&stepper.member_stepper, arena, &tvi_stepper_galerkin, system, options, member_count,
                                options->degree);
    stepper.single_stepper = stepper.member_stepper.stepper_work;
    allocate_node_arrays(&stepper.nodes, arena, system, options->degree, member_count);
    const size_t count = (size_t)member_count, n = (size_t)system->n * count,
                 unknowns = (size_t)system->input_count * count;
    galerkin_impulse_sums *sums = &stepper.tail_inputs.impulse_sums_over_nodes;
    double **const row_arrays[] = {&sums->rate_integral,
                                   &sums->rate_double_integral,
                                   &sums->last_term,
                                   &sums->end_impulse_size,
                                   &sums->rate_integral_low,
                                   &sums->rate_double_integral_low,
                                   &stepper.step_inputs.coordinate_drift_over_step,
                                   &stepper.step_inputs.coordinate_drift_over_step_low};
    double **const of_n[] = {&stepper.increments.dq,
                             &stepper.increments.dp,
                             &stepper.increments.dq_low,
                             &stepper.increments.dp_low,
                             &stepper.tail_inputs.component_share_of_subsystem_motion,
                             &stepper.tail_inputs.component_tail_ratio};
    for (size_t i = 0; i < 8; i++) *row_arrays[i] = tvi_arena_allocate_doubles(arena, unknowns);
    for (size_t i = 0; i < 6; i++) *of_n[i] = tvi_arena_allocate_doubles(arena, n);
    stepper.tail_of_member = tvi_arena_allocate_doubles(arena, count);
    stepper.stepped_together_mask = tvi_arena_allocate(arena, count * sizeof *stepper.stepped_together_mask);
    stepper.last_step_only_mask = tvi_arena_allocate(arena, count * sizeof *stepper.last_step_only_mask);
    stepper.history = tvi_arena_allocate_restored_if_step_fails(arena, count * sizeof *stepper.history);
    stepper.last_ring_index = tvi_arena_allocate_restored_if_step_fails(arena, sizeof *stepper.last_ring_index);
    for (int i = 0; i < GALERKIN_RING_LENGTH; i++)
        stepper.impulse_ring[i] =
            tvi_arena_allocate_restored_if_step_fails(arena, unknowns * (size_t)options->degree * sizeof(double));
    if (taken) *taken = stepper;
    return taken;
}

static void set_tables_of_batch_stepper(void *work)
{
    galerkin_batch_stepper *stepper = work;
    galerkin_stepper *single_stepper = stepper->single_stepper;
    galerkin_nodes *nodes = &stepper->nodes;
    double *const drift = stepper->step_inputs.coordinate_drift_over_step;
    double *const drift_low = stepper->step_inputs.coordinate_drift_over_step_low;
    tvi_member_stepper_set_tables(&stepper->member_stepper);
    const galerkin_nodes *member_nodes = &single_stepper->equations.nodes;
    nodes->moving_mask = stepper->iteration.moving_mask;
    nodes->lane_count = member_nodes->lane_count;
    nodes->moving_unknown_count = member_nodes->moving_unknown_count;
    nodes->impulse_weight = member_nodes->impulse_weight;
    nodes->unknown_change_per_impulse = member_nodes->unknown_change_per_impulse;
    nodes->momentum_that_moves_coordinate_by_1_in_step = member_nodes->momentum_that_moves_coordinate_by_1_in_step;
    nodes->subsystems = member_nodes->subsystems;
    const galerkin_tail_inputs arrays = stepper->tail_inputs;
    stepper->tail_inputs = single_stepper->tail_inputs;
    stepper->tail_inputs.impulse_sums_over_nodes = arrays.impulse_sums_over_nodes;
    stepper->tail_inputs.component_share_of_subsystem_motion = arrays.component_share_of_subsystem_motion;
    stepper->tail_inputs.component_tail_ratio = arrays.component_tail_ratio;
    stepper->step_inputs = single_stepper->step_inputs;
    stepper->step_inputs.kernels = *kernel_tables[single_stepper->equations.system->field_values->sweeps->isa];
    stepper->step_inputs.nodes = nodes;
    stepper->step_inputs.tail_inputs = &stepper->tail_inputs;
    stepper->step_inputs.coordinate_drift_over_step = drift;
    stepper->step_inputs.coordinate_drift_over_step_low = drift_low;
    stepper->step_inputs.impulse_ring = stepper->impulse_ring;
}

/* ---- Members one by one ------------------------------------------------------------------------------------------ */

/* Copies the impulses of one member from an array [unknowns][node_count][member_count] of the batch to an array
 * [unknowns][lanes]. scatter_member_impulses copies them back. */
static void gather_member_impulses(const galerkin_batch_stepper *stepper, const double *source, int member,
                                   double *destination)
{
    const galerkin_nodes *nodes = &stepper->nodes;
    for (int u = 0; u < nodes->unknown_count; u++)
        tvi_gather_member(nodes->node_count, nodes->member_count, source + u * nodes->node_count * nodes->member_count,
                          member, destination + u * nodes->lane_count);
}

static void scatter_member_impulses(const galerkin_batch_stepper *stepper, const double *source, int member,
                                    double *destination)
{
    const galerkin_nodes *nodes = &stepper->nodes;
    for (int u = 0; u < nodes->unknown_count; u++)
        tvi_scatter_member(nodes->node_count, nodes->member_count, source + u * nodes->lane_count, member,
                           destination + u * nodes->node_count * nodes->member_count);
}

static double *find_impulses_of_step(const galerkin_batch_stepper *stepper, int steps_after_last)
{
    return galerkin_find_impulses_in_ring(&stepper->step_inputs, (int)*stepper->last_ring_index + steps_after_last);
}

/* Copies the history of one lane to the history of a stepper of a single member. copy_history_to_lane copies it
 * back. */
static void copy_history_from_lane(const void *work, int lane, void *single_stepper)
{
    const galerkin_batch_stepper *stepper = work;
    const galerkin_predictor *predictor = &((galerkin_stepper *)single_stepper)->predictor;
    *predictor->history = stepper->history[lane];
    predictor->history->last_ring_index = 0;
    for (int i = 0; i < 2; i++)
        gather_member_impulses(stepper, find_impulses_of_step(stepper, -i), lane,
                               galerkin_find_impulses_of_step(predictor, -i));
}

static void copy_history_to_lane(void *work, int lane, const void *single_stepper)
{
    const galerkin_batch_stepper *stepper = work;
    const galerkin_predictor *predictor = &((const galerkin_stepper *)single_stepper)->predictor;
    stepper->history[lane] = *predictor->history;
    for (int i = 0; i < 2; i++)
        scatter_member_impulses(stepper, galerkin_find_impulses_of_step(predictor, -i), lane,
                                find_impulses_of_step(stepper, -i));
}

static void clear_lane_history(void *work, int lane)
{
    ((const galerkin_batch_stepper *)work)->history[lane] = (galerkin_history){0};
}

static bool is_impulse_ring_index_in_range(const void *work)
{
    return galerkin_is_ring_index_valid(*((const galerkin_batch_stepper *)work)->last_ring_index);
}

static void step_member_alone(galerkin_batch_stepper *stepper, double h, const tvi_batch_origin *origins,
                              const tvi_batch_results *results, int member, tvi_stats *stats)
{
    const jet_tape *tape = stepper->single_stepper->equations.system->field_values;
    copy_history_from_lane(stepper, member, stepper->single_stepper);
    if (tvi_step_member(&stepper->member_stepper, tape, stepper->nodes.values, stepper->nodes.node_count, h, origins,
                        results, member, stats))
        copy_history_to_lane(stepper, member, stepper->single_stepper);
}

/* ---- Members in lanes -------------------------------------------------------------------------------------------- */

/* Selects the members whose last step had size h and ended at the time t, so that this step can be made in lanes.
 * Returns the number of these members. */
static int select_members_to_step_together(galerkin_batch_stepper *stepper, double h, const double t[],
                                           const tvi_status status[])
{
    int count = 0;
    for (int member = 0; member < stepper->nodes.member_count; member++) {
        const galerkin_history *history = &stepper->history[member];
        const bool is_next = status[member] == TVI_OK && history->last_step_size == h &&
                             galerkin_follows_last_step(history, h, t[member]);
        stepper->iteration.largest_contraction_ratio[member] = history->convergence.largest_contraction_ratio;
        stepper->stepped_together_mask[member] = stepper->iteration.moving_mask[member] = is_next ? -1 : 0;
        stepper->last_step_only_mask[member] =
            galerkin_make_last_step_only_mask(&stepper->step_inputs, history->previous_step_size == h ? 2 : 1,
                                              history->convergence.first_movement_square);
        count += is_next;
    }
    return count;
}

/* Excludes a member from the passes that the members make together: clears its moving_mask, so that passes do not move
 * its unknowns, and sets them to the state at the start of its step, where the field can be evaluated. */
static void hold_excluded_member_at_start_state(galerkin_batch_stepper *stepper, int member)
{
    const galerkin_nodes *nodes = &stepper->nodes;
    stepper->iteration.moving_mask[member] = 0;
    for (int at = member; at < nodes->unknown_count * nodes->node_count * nodes->member_count;
         at += nodes->member_count) {
        nodes->impulses[at] = nodes->drift_values_low[at] = 0;
        nodes->drift_values[at] =
            nodes->start_values[at / (nodes->node_count * nodes->member_count) * nodes->member_count + member];
    }
}

static void set_node_times(const galerkin_batch_stepper *stepper, double h, const tvi_batch_origin *origins)
{
    const galerkin_nodes *nodes = &stepper->nodes;
    double *t = nodes->values + nodes->unknown_count * nodes->node_count * nodes->member_count;
    if (!stepper->single_stepper->equations.system->uses_time) return;
    for (int i = 0; i < nodes->node_count; i++)
        for (int member = 0; member < nodes->member_count; member++)
            *t++ = origins->t[member] +
                   (origins->t_low[member] + h * stepper->single_stepper->coefficients.node_abscissa[i]);
}

/* The structure that make_batch_pass gets as its argument `work`. */
typedef struct {
    galerkin_batch_stepper *stepper;
    tvi_stats *stats;
} batch_pass_work;

/* Makes a pass of the members whose moving_mask is set. A member whose unknowns leave the field's domain is stepped
 * alone afterwards. */
static tvi_status make_batch_pass(void *work, const galerkin_nodes *nodes, double movement[], double *roundoff)
{
    const batch_pass_work *pass_work = work;
    galerkin_batch_stepper *stepper = pass_work->stepper;
    const galerkin_equations *equations = &stepper->single_stepper->equations;
    const jet_tape *tape = equations->system->field_values;
    const bool is_inside = tape->sweeps->values(tape, nodes->values, nodes->node_count * nodes->member_count);
    (void)roundoff;
    for (int member = 0; member < nodes->member_count; member++) {
        if (!nodes->moving_mask[member]) continue;
        pass_work->stats->force_evaluations += nodes->node_count;
        pass_work->stats->passes++;
        if (!is_inside &&
            !tvi_is_member_inside_domain(&stepper->member_stepper, tape, nodes->values, nodes->node_count, member))
            hold_excluded_member_at_start_state(stepper, member);
    }
    stepper->step_inputs.kernels->move(nodes, stepper->step_inputs.node_impulse_to_node_unknown_matrix, nodes->values,
                                       equations->rate_row_of_unknown, movement);
    return TVI_OK;
}

/* Solves the equations of the step for all members in lanes. Clears stepped_together_mask of a member whose passes do
 * not converge: it is stepped alone afterwards. */
static void solve_step_equations_in_lanes(galerkin_batch_stepper *stepper, double h, const tvi_batch_origin *origins,
                                          const tvi_step_origin *origin, tvi_stats *stats)
{
    const galerkin_nodes *nodes = &stepper->nodes;
    const galerkin_extrapolation extrapolation = galerkin_select_extrapolation(
        &stepper->step_inputs, (int)*stepper->last_ring_index, stepper->last_step_only_mask);
    batch_pass_work pass_work = {stepper, stats};
    galerkin_set_drift_values(&stepper->step_inputs, nodes, origin);
    for (int member = 0; member < nodes->member_count; member++)
        if (!stepper->stepped_together_mask[member]) hold_excluded_member_at_start_state(stepper, member);
    stepper->step_inputs.kernels->predict(nodes, &extrapolation);
    set_node_times(stepper, h, origins);
    stepper->step_inputs.kernels->set_sizes(nodes, stepper->single_stepper->n);
    galerkin_make_passes_of_batch(&stepper->step_inputs, nodes,
                                  &(galerkin_pass_functions){.make_pass = make_batch_pass, .work = &pass_work},
                                  &stepper->iteration);
    for (int member = 0; member < nodes->member_count; member++)
        stepper->stepped_together_mask[member] = stepper->iteration.converged_mask[member];
}

/* Advances the index of the last step in the ring, which is the same for all members. Also moves the impulses of
 * members that are stepped alone by one place in the ring, so that their history stays the same. */
static void advance_impulse_ring(const galerkin_batch_stepper *stepper)
{
    const int member_count = stepper->nodes.member_count,
              rows = stepper->nodes.unknown_count * stepper->nodes.node_count;
    double *const before = find_impulses_of_step(stepper, -1), *const last = find_impulses_of_step(stepper, 0),
                  *const next = find_impulses_of_step(stepper, 1);
    for (int member = 0; member < member_count; member++)
        for (int at = member; at < rows * member_count && !stepper->stepped_together_mask[member]; at += member_count) {
            next[at] = last[at];
            last[at] = before[at];
        }
    *stepper->last_ring_index = (*stepper->last_ring_index + 1) % GALERKIN_RING_LENGTH;
}

/* Copies the numbers of the members in lanes from an array [row_count][member_count] to another one. Numbers of other
 * members are not changed. */
static void copy_rows_of_members_in_lanes(const galerkin_batch_stepper *stepper, int row_count, const double *source,
                                          double *destination)
{
    const int member_count = stepper->nodes.member_count;
    for (int i = 0; i < row_count; i++, source += member_count, destination += member_count)
        for (int member = 0; member < member_count; member++)
            destination[member] = stepper->stepped_together_mask[member] ? source[member] : destination[member];
}

/* Computes the increments and the tails of the members in lanes, and stores their results and their history. */
static void compute_results_of_members_in_lanes(galerkin_batch_stepper *stepper, double h,
                                                const tvi_batch_origin *origins, const tvi_step_origin *origin,
                                                const tvi_batch_results *results)
{
    const int n = stepper->single_stepper->n;
    galerkin_compute_increments(&stepper->step_inputs, &stepper->nodes, origin, &stepper->increments,
                                stepper->tail_of_member);
    advance_impulse_ring(stepper);
    copy_rows_of_members_in_lanes(stepper, n, stepper->increments.dq, results->increments.dq);
    copy_rows_of_members_in_lanes(stepper, n, stepper->increments.dp, results->increments.dp);
    copy_rows_of_members_in_lanes(stepper, n, stepper->increments.dq_low, results->increments.dq_low);
    copy_rows_of_members_in_lanes(stepper, n, stepper->increments.dp_low, results->increments.dp_low);
    copy_rows_of_members_in_lanes(stepper, 1, stepper->tail_of_member, results->tail);
    for (int member = 0; member < stepper->nodes.member_count; member++) {
        if (!stepper->stepped_together_mask[member]) continue;
        stepper->history[member] =
            (galerkin_history){.last_step_size = h,
                               .previous_step_size = h,
                               .last_step_start_time = origins->t[member],
                               .convergence = {stepper->iteration.largest_contraction_ratio[member],
                                               stepper->iteration.first_movement_square[member]}};
        results->pass_counts[member] = (int)stepper->iteration.pass_count_as_double[member];
    }
}

static void step_batch(void *work, double h, const tvi_batch_origin *origins, const tvi_batch_results *results,
                       tvi_stats *stats)
{
    galerkin_batch_stepper *stepper = work;
    const tvi_step_origin origin = {0, 0, origins->q, origins->q_low, origins->p, origins->p_low};
    tvi_galerkin_set_step_size(stepper->single_stepper, h);
    stepper->nodes.impulses = find_impulses_of_step(stepper, 1);
    if (select_members_to_step_together(stepper, h, origins->t, results->status) > 0) {
        solve_step_equations_in_lanes(stepper, h, origins, &origin, stats);
        compute_results_of_members_in_lanes(stepper, h, origins, &origin, results);
    }
    for (int member = 0; member < stepper->nodes.member_count; member++)
        if (results->status[member] == TVI_OK && !stepper->stepped_together_mask[member])
            step_member_alone(stepper, h, origins, results, member, stats);
}

const tvi_batch_stepper tvi_galerkin_batch = {.width = choose_batch_width,
                                              .allocate = allocate_batch_stepper,
                                              .set_tables = set_tables_of_batch_stepper,
                                              .step = step_batch,
                                              .copy_history_from_lane = copy_history_from_lane,
                                              .copy_history_to_lane = copy_history_to_lane,
                                              .clear_history = clear_lane_history,
                                              .is_history_valid = is_impulse_ring_index_in_range};
