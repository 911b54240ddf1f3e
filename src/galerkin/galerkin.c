/* galerkin.c - Makes steps of the Galerkin curve, whose unknowns are the values at m Gauss nodes. This is Gauss
 * collocation (docs/method.md section 4). With its coefficients a, b, c and the force F_j at node j the equations are,
 * for a separable system,
 *    Q_i = q0 + c_i h M^-1 p0 + h^2 sum_j (a a)_ij M^-1 F_j,
 *    q1 = q0 + h M^-1 (p0 + h sum_j b_j (1 - c_j) F_j),   p1 = p0 + h sum_j b_j F_j;
 * and for any other system, with (V, F) = (H_p, -H_q), or L_v(Q, V) = P and F = L_q (field.h),
 *    (Q, P)_i = (q0, p0) + h sum_j a_ij (V, F)_j,   (q1, p1) = (q0, p0) + h sum_j b_j (V, F)_j.
 * Passes, iterations that begin with a prediction from earlier steps, solve them. */
#include "compiled/code.h"
#include "galerkin/step.h"

#include <math.h>

enum { MAX_LANES = TVI_GALERKIN_MAX_LANES };

/* ---- Memory and tables ------------------------------------------------------------------------------------------- */

static int choose_lane_count(int node_count)
{
    int lanes = 1;
    while (lanes < node_count && lanes < 8) lanes *= 2;
    return node_count <= lanes ? lanes : MAX_LANES;
}

static int find_kernel_table_index(int lanes)
{
    int index = 0;
    while (1 << index < lanes) index++;
    return index;
}

/* The kernel tables of each instruction set. A system uses the instruction set of its tapes. */
static const galerkin_kernels *const *const kernel_tables[JET_ISA_COUNT] = {
    [jet_isa_base] = tvi_galerkin_kernels_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = tvi_galerkin_kernels_avx2,
    [jet_isa_avx512] = tvi_galerkin_kernels_avx512,
#endif
};

static const galerkin_field_form *select_field_form(const tvi_system *system)
{
    return !system->hessian_values          ? &tvi_galerkin_form_fixed_point
           : system->form == TVI_LAGRANGIAN ? &tvi_galerkin_form_lagrangian
                                            : &tvi_galerkin_form_hamiltonian;
}

/* Returns the rule that ends the passes. Without the term h g'' of the second derivatives of a Hamiltonian K = g h
 * (hamiltonian.c), each pass reduces the error by a constant factor only: this is not Newton's method. */
static const tvi_stopping_rule *select_passes_rule(const tvi_system *system)
{
    return !system->hessian_values                                          ? &tvi_galerkin_fixed_point
           : system->form == TVI_HAMILTONIAN && system->hessian_is_complete ? &tvi_galerkin_newton
                                                                            : &tvi_galerkin_quasi_newton;
}

/* Counts how many of the last coordinates are cyclic: H does not depend on them, as on the time of many rescaled
 * systems. The momentum is constant, and the coordinate follows from a quadrature: passes need not move them. */
static int count_trailing_cyclic_coordinates(const tvi_system *system)
{
    const int *force = system->field_values->output_slot;
    int count = 0;
    if (system->form != TVI_HAMILTONIAN) return 0;
    while (count < system->n && jet_tape_is_slot_always_zero(system->field_values, force[system->n - 1 - count]))
        count++;
    return count;
}

static void allocate_equations(galerkin_equations *equations, tvi_arena *arena, const tvi_system *system,
                               int node_count)
{
    galerkin_nodes *nodes = &equations->nodes;
    equations->system = system;
    equations->node_count = node_count;
    const int lanes_needed = choose_lane_count(node_count);
    equations->kernels = kernel_tables[system->field_values->sweeps->isa][find_kernel_table_index(lanes_needed)];
    equations->form = select_field_form(system);
    nodes->unknown_count = system->input_count;
    nodes->lane_count = lanes_needed;
    nodes->node_count = node_count;
    nodes->coordinate_unknown_count = system->n;
    nodes->subsystems = system->subsystems;
    const int cyclic = count_trailing_cyclic_coordinates(system);
    nodes->moving_unknown_count = cyclic > 0 ? system->n - cyclic : nodes->unknown_count;
    const size_t unknowns = (size_t)nodes->unknown_count, lanes = (size_t)nodes->lane_count;
    nodes->drift_values = tvi_arena_allocate_doubles(arena, unknowns * lanes);
    nodes->drift_values_low = tvi_arena_allocate_doubles(arena, unknowns * lanes);
    nodes->impulse_weight = tvi_arena_allocate_doubles(arena, lanes);
    nodes->start_values = tvi_arena_allocate_doubles(arena, unknowns);
    nodes->unknown_change_per_impulse = tvi_arena_allocate_doubles(arena, unknowns);
    nodes->inverse_unknown_size = tvi_arena_allocate_doubles(arena, unknowns);
    nodes->momentum_that_moves_coordinate_by_1_in_step = tvi_arena_allocate_doubles(arena, (size_t)system->n);
    equations->rate_row_of_unknown = tvi_arena_allocate(arena, unknowns * sizeof(int));
    equations->rate_per_impulse = tvi_arena_allocate_doubles(arena, unknowns);
}

static void allocate_tail_inputs(galerkin_tail_inputs *inputs, tvi_arena *arena, const tvi_system *system,
                                 double *unknown_change_per_impulse)
{
    galerkin_impulse_sums *sums = &inputs->impulse_sums_over_nodes;
    double **const vectors[] = {&sums->rate_integral,    &sums->rate_double_integral, &sums->last_term,
                                &sums->end_impulse_size, &sums->rate_integral_low,    &sums->rate_double_integral_low};
    for (size_t i = 0; i < 6; i++) *vectors[i] = tvi_arena_allocate_doubles(arena, (size_t)system->input_count + 7);
    inputs->n = system->n;
    inputs->is_separable = system->form == TVI_SEPARABLE;
    inputs->has_masses = system->has_tail_shares_without_momenta;
    inputs->subsystems = system->tail_subsystems;
    inputs->unknown_change_per_impulse = unknown_change_per_impulse;
    inputs->inverse_unknown_change_per_impulse = tvi_arena_allocate_doubles(arena, (size_t)system->n);
    inputs->component_share_of_subsystem_motion = tvi_arena_allocate_doubles(arena, (size_t)system->n);
    inputs->component_tail_ratio = tvi_arena_allocate_doubles(arena, (size_t)system->n);
}

static void *allocate_stepper(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    galerkin_stepper *taken = tvi_arena_allocate(arena, sizeof *taken);
    galerkin_stepper stepper = {.options = options, .n = system->n};
    allocate_equations(&stepper.equations, arena, system, options->degree);
    const int unknowns = stepper.equations.nodes.unknown_count, lanes = stepper.equations.nodes.lane_count;
    tvi_galerkin_allocate_coefficients(&stepper.coefficients, arena, stepper.equations.node_count, lanes);
    stepper.equations.node_weight = stepper.coefficients.node_weight;
    stepper.equations.node_impulse_to_node_unknown_matrix = stepper.coefficients.node_impulse_to_node_unknown_matrix;
    tvi_galerkin_allocate_predictor(&stepper.predictor, arena, &stepper.equations);
    tvi_galerkin_allocate_node_polynomials(&stepper.node_polynomials, arena, stepper.equations.node_count, lanes,
                                           system->field_values->sweeps);
    stepper.step_inputs.coordinate_drift_over_step = tvi_arena_allocate_doubles(arena, (size_t)unknowns);
    stepper.step_inputs.coordinate_drift_over_step_low = tvi_arena_allocate_doubles(arena, (size_t)unknowns);
    stepper.increment_per_impulse = tvi_arena_allocate_doubles(arena, 2 * (size_t)stepper.n);
    allocate_tail_inputs(&stepper.tail_inputs, arena, system, stepper.equations.nodes.unknown_change_per_impulse);
    stepper.equations.form->allocate(&stepper.equations, arena);
    tvi_galerkin_allocate_probe(&stepper.probe, arena, &stepper.equations);
    if (taken) *taken = stepper;
    return taken;
}

static void set_tables_of_stepper(void *work)
{
    galerkin_stepper *stepper = work;
    tvi_galerkin_compute_coefficients(&stepper->coefficients, &stepper->node_polynomials,
                                      galerkin_is_second_order(&stepper->equations));
    stepper->equations.form->set_tables(&stepper->equations);
    const int numbers = stepper->equations.nodes.unknown_count * stepper->equations.nodes.lane_count;
    tvi_galerkin_set_predictor_tables(&stepper->predictor, &stepper->coefficients, &stepper->equations);
    stepper->tail_inputs.inverse_weight_of_end_nodes = stepper->coefficients.inverse_weight_of_end_nodes;
    stepper->passes_rule =
        tvi_galerkin_scale_passes_rule(select_passes_rule(stepper->equations.system), numbers, stepper->options);
    const bool iterates = stepper->options->passes != TVI_PREDICT_ONLY;
    stepper->generated_code =
        stepper->equations.system->code && iterates ? stepper->equations.system->code->galerkin : NULL;
    stepper->step_inputs = (galerkin_step_inputs){
        .kernels = stepper->equations.kernels,
        .nodes = &stepper->equations.nodes,
        .tail_inputs = &stepper->tail_inputs,
        .impulse_sum_weights = &stepper->coefficients.impulse_sum_weights,
        .passes_rule = &stepper->passes_rule,
        .node_impulse_to_node_unknown_matrix = stepper->equations.node_impulse_to_node_unknown_matrix,
        .node_abscissa = stepper->coefficients.node_abscissa,
        .two_step_extrapolation = stepper->predictor.two_step_extrapolation,
        .last_step_extrapolation = stepper->predictor.last_step_extrapolation,
        .two_step_prediction_max_first_movement = stepper->predictor.two_step_prediction_max_first_movement,
        .impulse_ring = stepper->predictor.impulse_ring,
        .coordinate_drift_over_step = stepper->step_inputs.coordinate_drift_over_step,
        .coordinate_drift_over_step_low = stepper->step_inputs.coordinate_drift_over_step_low,
        .lagrangian_or_hamiltonian_pass_workspace = stepper->equations.lagrangian_or_hamiltonian_pass_workspace};
}

/* ---- The start of a step ----------------------------------------------------------------------------------------- */

void tvi_galerkin_set_step_size(galerkin_stepper *stepper, double h)
{
    const galerkin_nodes *nodes = &stepper->equations.nodes;
    if (h == stepper->equations.step_size) return;
    stepper->equations.step_size = h;
    for (int i = 0; i < nodes->lane_count; i++) nodes->impulse_weight[i] = h * stepper->equations.node_weight[i];
    for (int u = 0; u < nodes->unknown_count; u++) stepper->equations.rate_per_impulse[u] = 1 / h;
    for (int u = 0; u < nodes->unknown_count; u++)
        nodes->unknown_change_per_impulse[u] =
            galerkin_is_second_order(&stepper->equations) ? h / stepper->equations.system->mass[u]
            : u < stepper->n || stepper->equations.system->form == TVI_LAGRANGIAN ? 1
                                                                                  : -1;
    for (int i = 0; i < stepper->n; i++) {
        stepper->increment_per_impulse[i] = nodes->unknown_change_per_impulse[i];
        stepper->tail_inputs.inverse_unknown_change_per_impulse[i] = 1 / fabs(nodes->unknown_change_per_impulse[i]);
        nodes->momentum_that_moves_coordinate_by_1_in_step[i] =
            stepper->equations.system->has_masses ? stepper->equations.system->mass[i] / fabs(h) : INFINITY;
        stepper->increment_per_impulse[stepper->n + i] =
            galerkin_is_second_order(&stepper->equations) ? 1 : nodes->unknown_change_per_impulse[stepper->n + i];
    }
}

/* Writes the times of the nodes of a step of size h into the block of the field's tape, if the tape uses the time. */
static void set_node_times(galerkin_stepper *stepper, const tvi_step_origin *origin, double h)
{
    double t[MAX_LANES];
    if (!stepper->equations.system->uses_time) return;
    for (int i = 0; i < stepper->equations.nodes.lane_count; i++)
        t[i] = origin->t + (origin->t_low + h * stepper->coefficients.node_abscissa[i]);
    tvi_system_write_time(stepper->equations.system, stepper->equations.tape_block, stepper->equations.nodes.lane_count,
                          t);
}

/* Predicts the unknowns of a step that has no earlier step of the same size: extrapolates the last step, of which the
 * new step begins at the fraction *elapsed_fraction, or uses the field at the start if elapsed_fraction is NULL. */
static tvi_status predict_first_step(galerkin_stepper *stepper, const tvi_step_origin *origin,
                                     const double *elapsed_fraction, tvi_stats *stats)
{
    galerkin_equations *equations = &stepper->equations;
    equations->nodes.impulses = galerkin_find_impulses_of_step(&stepper->predictor, 1);
    galerkin_set_drift_values(&stepper->step_inputs, &equations->nodes, origin);
    if (elapsed_fraction) {
        tvi_galerkin_predict_from_last_step(&stepper->predictor, &stepper->coefficients, &stepper->node_polynomials,
                                            equations, *elapsed_fraction);
        return TVI_OK;
    }
    set_node_times(stepper, origin, 0);
    stats->force_evaluations++;
    return equations->form->predict_from_start(equations, origin);
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

/* The context of the passes of a step that the library makes without generated code. */
typedef struct {
    galerkin_stepper *stepper;
    const tvi_step_origin *origin;
    /* The counts of all evaluations and passes, and a copy of them from the end of the last completed step. */
    tvi_stats *stats, stats_of_completed_steps;
} pass_context_without_generated_code;

/* Makes the next pass of a step. If the movements of passes no longer shrink, also measures their roundoff, provided
 * that the movement is as small as roundoff or that the nodes are near the start of the step. Otherwise the step is too
 * large, and its movements back and forth are no roundoff. */
JET_INLINE tvi_status make_pass_without_generated_code(void *work, const galerkin_nodes *nodes, double *movement,
                                                       double *roundoff)
{
    const pass_context_without_generated_code *step = work;
    galerkin_equations *equations = &step->stepper->equations;
    (void)nodes;
    if (roundoff && (*movement <= step->stepper->passes_rule.roundoff_level ||
                     tvi_galerkin_are_nodes_near_start(equations, step->origin)))
        return tvi_galerkin_measure_roundoff(equations, &step->stepper->probe, movement, roundoff, step->stats);
    return galerkin_make_pass(equations, movement, step->stats);
}

JET_INLINE void predict_unknowns_without_generated_code(void *work, const galerkin_nodes *nodes,
                                                        const galerkin_extrapolation *extrapolation)
{
    const pass_context_without_generated_code *step = work;
    (void)nodes;
    galerkin_predict_unknowns(&step->stepper->equations, extrapolation);
}

static void keep_stats_to_exclude_later_failed_step(void *work)
{
    pass_context_without_generated_code *step = work;
    step->stats_of_completed_steps = *step->stats;
}

static void make_steps_without_generated_code(galerkin_stepper *stepper, const tvi_run_request *run,
                                              const tvi_step_origin *origin, const tvi_run_state *state,
                                              galerkin_steps_outcome *outcome, tvi_stats *stats)
{
    pass_context_without_generated_code step = {.stepper = stepper, .origin = origin, .stats = stats};
    galerkin_make_steps(&stepper->step_inputs, &stepper->equations.nodes,
                        &(galerkin_pass_functions){make_pass_without_generated_code,
                                                   predict_unknowns_without_generated_code,
                                                   keep_stats_to_exclude_later_failed_step, &step},
                        run, origin, state, outcome);
    if (outcome->step_count > 0) *stats = step.stats_of_completed_steps;
}

static void make_steps_by_generated_code(galerkin_stepper *stepper, const tvi_run_request *run,
                                         const tvi_step_origin *origin, const tvi_run_state *state,
                                         galerkin_steps_outcome *outcome, tvi_stats *stats)
{
    stepper->generated_code->steps(&stepper->step_inputs, run, origin, state, outcome);
    const long passes = outcome->pass_count + (outcome->step_count < 1 ? outcome->pass_count_of_failed_step : 0);
    stats->passes += passes;
    stats->force_evaluations += passes * stepper->equations.node_count;
    stats->factorisations += outcome->inversion_pass_count * stepper->equations.node_count;
}

typedef void step_maker(galerkin_stepper *stepper, const tvi_run_request *run, const tvi_step_origin *origin,
                        const tvi_run_state *state, galerkin_steps_outcome *outcome, tvi_stats *stats);

/* Makes steps by generated code or by the library. The first step is predicted from earlier steps if
 * can_use_earlier_steps is set and the last step is near enough, and otherwise from the state alone. */
static galerkin_steps_outcome predict_and_make_steps(galerkin_stepper *stepper, step_maker *make_steps,
                                                     bool can_use_earlier_steps, const tvi_run_request *run,
                                                     const tvi_step_origin *origin, const tvi_run_state *state,
                                                     tvi_stats *stats)
{
    const double h = run->h;
    galerkin_history *history = stepper->predictor.history;
    galerkin_steps_outcome outcome = {.last_ring_index = (int)history->last_ring_index,
                                      .largest_tail = stats->largest_tail};
    double elapsed_fraction;
    tvi_galerkin_set_step_size(stepper, h);
    if (h == history->last_step_size) outcome.convergence = history->convergence;
    if (can_use_earlier_steps)
        outcome.is_first_step_extrapolated = tvi_galerkin_can_predict_from_last_step(
            &stepper->predictor, &stepper->equations, origin->t, &elapsed_fraction);
    if (outcome.is_first_step_extrapolated && elapsed_fraction == 1 && h == history->last_step_size)
        outcome.equal_step_count = h == history->previous_step_size ? 2 : 1;
    if (outcome.equal_step_count == 0)
        outcome.status =
            predict_first_step(stepper, origin, outcome.is_first_step_extrapolated ? &elapsed_fraction : NULL, stats);
    if (outcome.status != TVI_OK) return outcome;
    set_node_times(stepper, origin, h);
    make_steps(stepper, run, origin, state, &outcome, stats);
    if (outcome.step_count < 1) return outcome;
    *history = (galerkin_history){.last_step_size = h,
                                  .previous_step_size = outcome.step_count > 1 ? h : history->last_step_size,
                                  .last_step_start_time = outcome.start_time_of_last_step,
                                  .convergence = outcome.convergence,
                                  .last_ring_index = outcome.last_ring_index};
    stats->residual = sqrt(outcome.last_pass_movement_square);
    stats->tail = outcome.last_tail;
    return outcome;
}

/* Makes a step, predicted from earlier steps, and if the passes do not converge, again, predicted from its start. */
static tvi_status make_single_step(void *work, double h, const tvi_step_origin *origin,
                                   const tvi_increments *increments, tvi_stats *stats)
{
    galerkin_stepper *stepper = work;
    const tvi_run_request run = {
        .h = h, .max_steps = 1, .index_of_time_in_q = -1, .last_step_increments_out = *increments};
    const bool iterates = stepper->passes_rule.max_passes > 0;
    galerkin_steps_outcome outcome = {.step_count = 0};
    if (stepper->generated_code)
        outcome = predict_and_make_steps(stepper, make_steps_by_generated_code, true, &run, origin, NULL, stats);
    if (outcome.step_count < 1)
        outcome =
            predict_and_make_steps(stepper, make_steps_without_generated_code, iterates, &run, origin, NULL, stats);
    if (outcome.step_count < 1 && outcome.is_first_step_extrapolated)
        outcome = predict_and_make_steps(stepper, make_steps_without_generated_code, false, &run, origin, NULL, stats);
    return outcome.step_count > 0 ? TVI_OK : outcome.status;
}

static long make_steps_of_run(void *work, const tvi_run_request *run, const tvi_run_state *state, tvi_stats *stats)
{
    galerkin_stepper *stepper = work;
    const tvi_step_origin origin = {state->q[stepper->n], state->q_low[stepper->n], state->q, state->q_low, state->p,
                                    state->p_low};
    tvi_stats counted = *stats;
    if (stepper->passes_rule.max_passes < 1 || stepper->equations.system->uses_time) return 0;
    const galerkin_steps_outcome outcome = predict_and_make_steps(
        stepper, stepper->generated_code ? make_steps_by_generated_code : make_steps_without_generated_code, true, run,
        &origin, state, &counted);
    if (outcome.step_count < 1) return 0;
    *stats = counted;
    stats->largest_tail = outcome.largest_tail;
    return outcome.step_count;
}

/* ---- Generated code ---------------------------------------------------------------------------------------------- */

static void emit_generated_steps(jet_text *text, const tvi_system *system, const tvi_options *options)
{
    tvi_arena arena = {0};
    (void)allocate_stepper(&arena, system, options);
    void *memory = tvi_arena_obtain_memory(&arena);
    galerkin_stepper *stepper = memory ? allocate_stepper(&arena, system, options) : NULL;
    text->is_incomplete |= !stepper;
    if (!stepper) return;
    set_tables_of_stepper(stepper);
    tvi_galerkin_emit_steps(text, &stepper->equations, &stepper->passes_rule);
    free(memory);
}

static tvi_tapes_of_steps list_used_tapes(const tvi_system *system, const tvi_options *options)
{
    const int lanes = choose_lane_count(options->degree);
    tvi_tapes_of_steps used = {.value_tape_emission = {.name_prefix = "tvi_values", .value_lane_counts = {lanes}},
                               .emit_loops = emit_generated_steps};
    if (system->hessian_values)
        used.hessian_tape_emission = (jet_emission_request){.name_prefix = "tvi_hessian", .value_lane_counts = {lanes}};
    return used;
}

static bool is_history_valid(const void *work)
{
    return galerkin_is_ring_index_valid(((const galerkin_stepper *)work)->predictor.history->last_ring_index);
}

const tvi_stepper tvi_stepper_galerkin = {.allocate = allocate_stepper,
                                          .set_tables = set_tables_of_stepper,
                                          .step = make_single_step,
                                          .run = make_steps_of_run,
                                          .interpolate = tvi_galerkin_compute_dense_output,
                                          .sample = tvi_galerkin_compute_curve_samples,
                                          .is_superconvergent = true,
                                          .is_history_valid = is_history_valid,
                                          .list_tapes = list_used_tapes};
