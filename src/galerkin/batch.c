/* batch.c - Makes steps of the Galerkin curves of several members of an ensemble at once, by the text of steps.h.
 * Number i * width + m of a row is node i of member m.
 *
 * Each member has its own convergence: a member that has converged moves no more, and the others go on. A step in lanes
 * continues a step of the same size. All other steps, as the first one of a run, and steps that fail or whose roundoff
 * has to be measured, are made by the stepper of a single curve, one after the other. */
#include "compiled/code.h"
#include "galerkin/step.h"
#include "method/single.h"

enum { MOST_LANES = 256 };
/* The largest block of the tape, which is partly in the second-level cache. A block of the least width may be larger,
 * except if a whole step is generated code, which then is faster. */
enum { MOST_BYTES = 40 << 10, MOST_BYTES_OF_ALL = 128 << 10 };

/* The history of each member's last two steps, as galerkin_history has it for one member, [member_count] each. */
typedef struct {
    double *step_size, *previous_step_size, *start_time;
    galerkin_convergence *convergence;
} galerkin_batch_history;

typedef struct {
    tvi_member_stepper single_member;
    galerkin_stepper *galerkin; /* the work of single_member, which contains all tables */
    galerkin_nodes nodes;
    galerkin_tail_inputs tail_inputs;
    galerkin_step_data step_data;
    galerkin_batch_convergence convergence;
    /* [member_count] Masks, with all bits set or none: is_in_lanes if the member steps together with others, and the
     * result of galerkin_is_prediction_rough. */
    long long *is_in_lanes, *is_rough;
    tvi_increments increments;       /* [n][member_count] the increments of the state */
    double *tail_share, *tail_ratio; /* [n][width] */
    double *tail;                    /* [width] */
    /* These are stored in the arena's history, like last_ring_index and the impulses. */
    galerkin_batch_history history;
    long *last_ring_index;
    /* [unknowns][node_count][member_count] The impulses of the last two steps and of the next one. */
    double *impulse_ring[GALERKIN_RING];
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
    const int node_count = options->degree, bytes = system->field_values->slots * node_count * (int)sizeof(double);
    if (!tvi_galerkin_needs_no_hessian(system) || options->passes == TVI_PREDICT_ONLY) return 1;
    const bool has_steps = system->code && system->code->galerkin;
    if (TVI_LEAST_WIDTH * bytes > (has_steps ? MOST_BYTES : MOST_BYTES_OF_ALL)) return 1;
    int member_count = TVI_LEAST_WIDTH;
    while (2 * member_count <= TVI_MOST_WIDTH && 2 * member_count * node_count <= MOST_LANES &&
           2 * member_count * bytes <= MOST_BYTES)
        member_count *= 2;
    return member_count;
}

static void allocate_node_arrays(galerkin_nodes *nodes, tvi_arena *arena, const tvi_system *system, int node_count,
                                 int member_count)
{
    const size_t of_unknowns = (size_t)system->inputs * (size_t)member_count,
                 numbers = of_unknowns * (size_t)node_count;
    *nodes = (galerkin_nodes){
        .unknowns = system->inputs, .half_unknowns = system->n, .node_count = node_count, .member_count = member_count};
    nodes->values = tvi_arena_allocate_block(arena, system->field_values, 1, node_count * member_count, 0);
    nodes->start_values = tvi_arena_allocate_doubles(arena, of_unknowns);
    nodes->free_values = tvi_arena_allocate_doubles(arena, numbers);
    nodes->free_values_low = tvi_arena_allocate_doubles(arena, numbers);
    nodes->inverse_size = tvi_arena_allocate_doubles(arena, of_unknowns);
}

static void allocate_batch_history(galerkin_batch_stepper *batch, tvi_arena *arena, size_t numbers)
{
    const size_t member_count = (size_t)batch->nodes.member_count;
    double **const of_last[] = {&batch->history.step_size, &batch->history.previous_step_size,
                                &batch->history.start_time};
    for (size_t i = 0; i < 3; i++) *of_last[i] = tvi_arena_allocate_in_history(arena, member_count * sizeof(double));
    batch->history.convergence =
        tvi_arena_allocate_in_history(arena, member_count * sizeof *batch->history.convergence);
    batch->last_ring_index = tvi_arena_allocate_in_history(arena, sizeof *batch->last_ring_index);
    for (int i = 0; i < GALERKIN_RING; i++)
        batch->impulse_ring[i] = tvi_arena_allocate_in_history(arena, numbers * sizeof(double));
}

static void *allocate_batch_stepper(tvi_arena *arena, const tvi_system *system, const tvi_options *options,
                                    int member_count)
{
    galerkin_batch_stepper *taken = tvi_arena_allocate(arena, sizeof *taken);
    galerkin_batch_stepper batch = {.last_ring_index = NULL};
    tvi_member_stepper_allocate(&batch.single_member, arena, &tvi_stepper_galerkin, system, options, member_count,
                                options->degree);
    batch.galerkin = batch.single_member.stepper_work;
    allocate_node_arrays(&batch.nodes, arena, system, options->degree, member_count);
    const size_t count = (size_t)member_count, n = (size_t)system->n * count, unknowns = (size_t)system->inputs * count;
    galerkin_impulse_sums *sums = &batch.tail_inputs.impulse_sums;
    double **const of_unknowns[] = {&sums->single_integral,  &sums->double_integral,     &sums->last_term,
                                    &sums->end_impulse_size, &sums->single_integral_low, &sums->double_integral_low,
                                    &batch.step_data.drift,  &batch.step_data.drift_low};
    double **const of_n[] = {&batch.increments.dq,     &batch.increments.dp, &batch.increments.dq_low,
                             &batch.increments.dp_low, &batch.tail_share,    &batch.tail_ratio};
    for (size_t i = 0; i < 8; i++) *of_unknowns[i] = tvi_arena_allocate_doubles(arena, unknowns);
    for (size_t i = 0; i < 6; i++) *of_n[i] = tvi_arena_allocate_doubles(arena, n);
    batch.tail = tvi_arena_allocate_doubles(arena, count);
    batch.is_in_lanes = tvi_arena_allocate(arena, count * sizeof *batch.is_in_lanes);
    batch.is_rough = tvi_arena_allocate(arena, count * sizeof *batch.is_rough);
    allocate_batch_history(&batch, arena, unknowns * (size_t)options->degree);
    if (taken) *taken = batch;
    return taken;
}

static void prepare_batch_stepper(void *work)
{
    galerkin_batch_stepper *batch = work;
    galerkin_stepper *single = batch->galerkin;
    galerkin_nodes *nodes = &batch->nodes;
    double *const drift = batch->step_data.drift, *const drift_low = batch->step_data.drift_low;
    tvi_member_stepper_set_tables(&batch->single_member);
    const galerkin_nodes *of_one = &single->field.nodes;
    nodes->is_member_moving = batch->convergence.is_moving;
    nodes->lanes = of_one->lanes;
    nodes->moving_unknowns = of_one->moving_unknowns;
    nodes->impulse_weight = of_one->impulse_weight;
    nodes->impulse_scale = of_one->impulse_scale;
    nodes->momentum_per_movement = of_one->momentum_per_movement;
    nodes->subsystems = of_one->subsystems;
    const galerkin_impulse_sums sums = batch->tail_inputs.impulse_sums;
    batch->tail_inputs = single->tail_inputs;
    batch->tail_inputs.impulse_sums = sums;
    batch->step_data = single->step_data;
    batch->step_data.kernels = *kernel_tables[single->field.system->field_values->sweeps->isa];
    batch->step_data.nodes = nodes;
    batch->step_data.tail_inputs = &batch->tail_inputs;
    batch->step_data.drift = drift;
    batch->step_data.drift_low = drift_low;
    batch->step_data.tail_share = batch->tail_share;
    batch->step_data.tail_ratio = batch->tail_ratio;
    batch->step_data.impulse_ring = batch->impulse_ring;
}

/* ---- Members one by one ------------------------------------------------------------------------------------------ */

/* Copies the impulses of one member from the batch's array [unknowns][node_count][member_count] to an array
 * [unknowns][lanes]. */
static void gather_member_impulses(const galerkin_batch_stepper *batch, const double *source, int member,
                                   double *destination)
{
    const galerkin_nodes *nodes = &batch->nodes;
    for (int u = 0; u < nodes->unknowns; u++)
        tvi_gather_member(nodes->node_count, nodes->member_count, source + u * nodes->node_count * nodes->member_count,
                          member, destination + u * nodes->lanes);
}

static void scatter_member_impulses(const galerkin_batch_stepper *batch, const double *source, int member,
                                    double *destination)
{
    const galerkin_nodes *nodes = &batch->nodes;
    for (int u = 0; u < nodes->unknowns; u++)
        tvi_scatter_member(nodes->node_count, nodes->member_count, source + u * nodes->lanes, member,
                           destination + u * nodes->node_count * nodes->member_count);
}

static double *impulses_of_step(const galerkin_batch_stepper *batch, int steps_after_last)
{
    return galerkin_impulses_in_ring(&batch->step_data, (int)*batch->last_ring_index + steps_after_last);
}

/* Copies the history of one lane to the history of a stepper for a single member. */
static void copy_history_from_lane(const void *work, int lane, void *single_stepper)
{
    const galerkin_batch_stepper *batch = work;
    const galerkin_predictor *predictor = &((galerkin_stepper *)single_stepper)->predictor;
    const galerkin_batch_history *last = &batch->history;
    *predictor->history = (galerkin_history){.step_size = last->step_size[lane],
                                             .previous_step_size = last->previous_step_size[lane],
                                             .start_time = last->start_time[lane],
                                             .convergence = last->convergence[lane]};
    for (int i = 0; i < 2; i++)
        gather_member_impulses(batch, impulses_of_step(batch, -i), lane, tvi_galerkin_impulses_of_step(predictor, -i));
}

static void copy_history_to_lane(void *work, int lane, const void *single_stepper)
{
    const galerkin_batch_stepper *batch = work;
    const galerkin_predictor *predictor = &((const galerkin_stepper *)single_stepper)->predictor;
    batch->history.step_size[lane] = predictor->history->step_size;
    batch->history.previous_step_size[lane] = predictor->history->previous_step_size;
    batch->history.start_time[lane] = predictor->history->start_time;
    batch->history.convergence[lane] = predictor->history->convergence;
    for (int i = 0; i < 2; i++)
        scatter_member_impulses(batch, tvi_galerkin_impulses_of_step(predictor, -i), lane, impulses_of_step(batch, -i));
}

static void forget_lane_history(void *work, int lane)
{
    const galerkin_batch_stepper *batch = work;
    batch->history.step_size[lane] = batch->history.previous_step_size[lane] = batch->history.start_time[lane] = 0;
    batch->history.convergence[lane] = (galerkin_convergence){0};
}

static bool is_ring_index_valid(const void *work)
{
    const long ring_index = *((const galerkin_batch_stepper *)work)->last_ring_index;
    return ring_index >= 0 && ring_index < GALERKIN_RING;
}

static void step_member_alone(galerkin_batch_stepper *batch, double h, const tvi_batch_origin *origin,
                              const tvi_batch_results *end, int member, tvi_stats *stats)
{
    const jet_tape *tape = batch->galerkin->field.system->field_values;
    copy_history_from_lane(batch, member, batch->galerkin);
    if (tvi_step_member(&batch->single_member, tape, batch->nodes.values, batch->nodes.node_count, h, origin, end,
                        member, stats))
        copy_history_to_lane(batch, member, batch->galerkin);
}

/* ---- Members in lanes -------------------------------------------------------------------------------------------- */

/* Selects the members whose last step had size h and ended at the time t, so that this step can be made in lanes.
 * Returns how many they are. */
static int select_members_that_continue(galerkin_batch_stepper *batch, double h, const double t[],
                                        const tvi_status status[])
{
    const galerkin_batch_history *last = &batch->history;
    int count = 0;
    for (int member = 0; member < batch->nodes.member_count; member++) {
        const bool goes_on = status[member] == TVI_OK && last->step_size[member] == h &&
                             fabs(t[member] - (last->start_time[member] + h)) < 0.25 * fabs(h);
        batch->convergence.slowest_contraction[member] = last->convergence[member].slowest_contraction;
        batch->is_in_lanes[member] = batch->convergence.is_moving[member] = goes_on ? -1 : 0;
        batch->is_rough[member] = galerkin_is_prediction_rough(
            &batch->step_data, last->previous_step_size[member] == h ? 2 : 1, last->convergence[member].first_movement);
        count += goes_on;
    }
    return count;
}

/* Sets the unknowns of a member that is stepped alone to the start of its step, where the field can be evaluated,
 * and lets no pass move them. */
static void freeze_member_at_start(galerkin_batch_stepper *batch, int member)
{
    const galerkin_nodes *nodes = &batch->nodes;
    batch->convergence.is_moving[member] = 0;
    for (int at = member; at < nodes->unknowns * nodes->node_count * nodes->member_count; at += nodes->member_count) {
        nodes->impulses[at] = nodes->free_values_low[at] = 0;
        nodes->free_values[at] =
            nodes->start_values[at / (nodes->node_count * nodes->member_count) * nodes->member_count + member];
    }
}

static void set_node_times(const galerkin_batch_stepper *batch, double h, const tvi_batch_origin *origin)
{
    const galerkin_nodes *nodes = &batch->nodes;
    double *t = nodes->values + nodes->unknowns * nodes->node_count * nodes->member_count;
    if (!batch->galerkin->field.system->uses_time) return;
    for (int i = 0; i < nodes->node_count; i++)
        for (int member = 0; member < nodes->member_count; member++)
            *t++ = origin->t[member] + (origin->t_low[member] + h * batch->galerkin->coefficients.node_abscissa[i]);
}

/* The data of a pass of all members that are stepped in lanes. */
typedef struct {
    galerkin_batch_stepper *batch;
    tvi_stats *stats;
} batch_pass_work;

/* Makes a pass of all members in lanes. Members whose unknowns leave the field's domain are stepped alone
 * afterwards. */
static tvi_status make_batch_pass(void *work, const galerkin_nodes *nodes, double moved[], double *roundoff)
{
    const batch_pass_work *step = work;
    galerkin_batch_stepper *batch = step->batch;
    const galerkin_field *field = &batch->galerkin->field;
    const jet_tape *tape = field->system->field_values;
    const bool is_inside = tape->sweeps->values(tape, nodes->values, nodes->node_count * nodes->member_count);
    (void)roundoff;
    for (int member = 0; member < nodes->member_count; member++) {
        if (!nodes->is_member_moving[member]) continue;
        step->stats->force_evaluations += nodes->node_count;
        step->stats->passes++;
        if (!is_inside &&
            !tvi_is_member_inside_domain(&batch->single_member, tape, nodes->values, nodes->node_count, member))
            freeze_member_at_start(batch, member);
    }
    batch->step_data.kernels->move(nodes, batch->step_data.impulse_matrix, nodes->values, field->rate_row, moved);
    return TVI_OK;
}

static void solve_members_in_lanes(galerkin_batch_stepper *batch, double h, const tvi_batch_origin *origin,
                                   const tvi_step_origin *lanes_origin, tvi_stats *stats)
{
    const galerkin_nodes *nodes = &batch->nodes;
    const galerkin_extrapolation by =
        galerkin_extrapolate_last_steps(&batch->step_data, (int)*batch->last_ring_index, batch->is_rough);
    batch_pass_work step = {batch, stats};
    galerkin_start_unknowns(&batch->step_data, nodes, lanes_origin);
    for (int member = 0; member < nodes->member_count; member++)
        if (!batch->is_in_lanes[member]) freeze_member_at_start(batch, member);
    batch->step_data.kernels->predict(nodes, &by);
    set_node_times(batch, h, origin);
    batch->step_data.kernels->set_sizes(nodes, batch->galerkin->n);
    galerkin_iterate_members(&batch->step_data, nodes,
                             &(galerkin_pass_functions){.pass = make_batch_pass, .work = &step}, &batch->convergence);
    for (int member = 0; member < nodes->member_count; member++)
        batch->is_in_lanes[member] = batch->convergence.has_ended[member];
}

/* Moves the impulses of members that are not stepped in lanes by one place in the ring, so that their history stays
 * the same when the ring advances. */
static void keep_impulses_of_other_members(const galerkin_batch_stepper *batch)
{
    const int member_count = batch->nodes.member_count, rows = batch->nodes.unknowns * batch->nodes.node_count;
    double *const before = impulses_of_step(batch, -1), *const last = impulses_of_step(batch, 0),
                  *const next = impulses_of_step(batch, 1);
    for (int member = 0; member < member_count; member++)
        for (int at = member; at < rows * member_count && !batch->is_in_lanes[member]; at += member_count) {
            next[at] = last[at];
            last[at] = before[at];
        }
    *batch->last_ring_index = (*batch->last_ring_index + 1) % GALERKIN_RING;
}

/* Copies the numbers of all members that were stepped in lanes. */
static void copy_members_in_lanes(const galerkin_batch_stepper *batch, int rows, const double *source,
                                  double *destination)
{
    const int member_count = batch->nodes.member_count;
    for (int i = 0; i < rows; i++, source += member_count, destination += member_count)
        for (int member = 0; member < member_count; member++)
            destination[member] = batch->is_in_lanes[member] ? source[member] : destination[member];
}

static void finish_step_in_lanes(galerkin_batch_stepper *batch, double h, const tvi_batch_origin *origin,
                                 const tvi_step_origin *lanes_origin, const tvi_batch_results *end)
{
    const int n = batch->galerkin->n;
    galerkin_compute_increments(&batch->step_data, &batch->nodes, lanes_origin, &batch->increments, batch->tail);
    keep_impulses_of_other_members(batch);
    copy_members_in_lanes(batch, n, batch->increments.dq, end->increments.dq);
    copy_members_in_lanes(batch, n, batch->increments.dp, end->increments.dp);
    copy_members_in_lanes(batch, n, batch->increments.dq_low, end->increments.dq_low);
    copy_members_in_lanes(batch, n, batch->increments.dp_low, end->increments.dp_low);
    copy_members_in_lanes(batch, 1, batch->tail, end->tail);
    copy_members_in_lanes(batch, 1, origin->t, batch->history.start_time);
    for (int member = 0; member < batch->nodes.member_count; member++) {
        if (!batch->is_in_lanes[member]) continue;
        batch->history.previous_step_size[member] = h;
        batch->history.convergence[member] = (galerkin_convergence){batch->convergence.slowest_contraction[member],
                                                                    batch->convergence.first_movement[member]};
        end->passes[member] = (int)batch->convergence.pass_count[member];
    }
}

static void step_batch(void *work, double h, const tvi_batch_origin *origin, const tvi_batch_results *end,
                       tvi_stats *stats)
{
    galerkin_batch_stepper *batch = work;
    const tvi_step_origin lanes_origin = {0, 0, origin->q, origin->q_low, origin->p, origin->p_low};
    tvi_galerkin_set_step_size(batch->galerkin, h);
    batch->nodes.impulses = impulses_of_step(batch, 1);
    if (select_members_that_continue(batch, h, origin->t, end->status) > 0) {
        solve_members_in_lanes(batch, h, origin, &lanes_origin, stats);
        finish_step_in_lanes(batch, h, origin, &lanes_origin, end);
    }
    for (int member = 0; member < batch->nodes.member_count; member++)
        if (end->status[member] == TVI_OK && !batch->is_in_lanes[member])
            step_member_alone(batch, h, origin, end, member, stats);
}

const tvi_batch_stepper tvi_galerkin_batch = {.width = choose_batch_width,
                                              .take = allocate_batch_stepper,
                                              .prepare = prepare_batch_stepper,
                                              .step = step_batch,
                                              .lane_to_scalar = copy_history_from_lane,
                                              .scalar_to_lane = copy_history_to_lane,
                                              .forget = forget_lane_history,
                                              .is_history_valid = is_ring_index_valid};
