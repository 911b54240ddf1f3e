/* galerkin.c - Makes the steps of the Galerkin curve by steps.h, for any system, or by generated code for one: sets the
 * weights of a step, chooses its prediction, and keeps the history. Evaluates the curve of the last step. The table at
 * the end is the stepper of "galerkin", of which there is one for each instruction set. */
#include "galerkin/galerkin.h"
#include "compiled/code.h"

#include <stdlib.h>

/* ---- Memory and tables ------------------------------------------------------------------------------------------- */

static int choose_lane_count(int node_count) { return node_count <= 4 ? 4 : node_count <= 8 ? 8 : GALERKIN_MAX_LANES; }

/* Counts how many of the last coordinates are cyclic: H does not depend on them, as on the time of many rescaled
 * systems. The momentum is constant, and the coordinate follows from a quadrature: passes need not move them. */
static int count_cyclic_coordinates(const tvi_system *system)
{
    const int *force = system->field_values->output_slot;
    int count = 0;
    if (system->form != TVI_HAMILTONIAN) return 0;
    while (count < system->n && jet_tape_is_slot_always_zero(system->field_values, force[system->n - 1 - count]))
        count++;
    return count;
}

static void allocate_nodes(galerkin_nodes *nodes, tvi_arena *arena, const tvi_system *system, int node_count)
{
    const int cyclic = count_cyclic_coordinates(system);
    nodes->node_count = node_count;
    nodes->lane_count = choose_lane_count(node_count);
    nodes->unknown_count = system->input_count;
    nodes->n = system->n;
    nodes->moving_count = cyclic > 0 ? system->n - cyclic : nodes->unknown_count;
    nodes->subsystems = system->subsystems;
    const size_t unknowns = (size_t)nodes->unknown_count, lanes = (size_t)nodes->lane_count;
    nodes->drift = tvi_arena_allocate_doubles(arena, unknowns * lanes);
    nodes->drift_low = tvi_arena_allocate_doubles(arena, unknowns * lanes);
    nodes->hb = tvi_arena_allocate_doubles(arena, lanes);
    nodes->start = tvi_arena_allocate_doubles(arena, unknowns);
    nodes->scale = tvi_arena_allocate_doubles(arena, unknowns);
    nodes->inverse_size = tvi_arena_allocate_doubles(arena, unknowns);
    nodes->m_over_h = tvi_arena_allocate_doubles(arena, (size_t)system->n);
}

static void allocate_tail(galerkin_tail *tail, tvi_arena *arena, const tvi_system *system, const double *scale)
{
    galerkin_sums *sums = &tail->sums;
    tvi_arena_allocate_each(arena, (size_t)system->input_count + 7,
                            (double **[]){&sums->once, &sums->once_low, &sums->twice, &sums->twice_low,
                                          &sums->last_term, &sums->ends, NULL});
    tail->n = system->n;
    tail->is_separable = system->form == TVI_SEPARABLE;
    tail->has_masses = system->has_tail_shares_without_momenta;
    tail->subsystems = system->tail_subsystems;
    tail->scale = scale;
    tail->inverse_scale = tvi_arena_allocate_doubles(arena, (size_t)system->n);
    tail->share = tvi_arena_allocate_doubles(arena, (size_t)system->n);
    tail->ratio = tvi_arena_allocate_doubles(arena, (size_t)system->n);
}

static void *allocate_stepper(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    galerkin_stepper *taken = tvi_arena_allocate(arena, sizeof *taken);
    galerkin_stepper stepper = {.options = options, .n = system->n};
    galerkin_step *step = &stepper.step;
    step->system = system;
    step->is_separable = system->form == TVI_SEPARABLE;
    allocate_nodes(&step->nodes, arena, system, options->degree);
    const size_t unknowns = (size_t)step->nodes.unknown_count;
    tvi_galerkin_allocate_tables(&stepper.coefficients, &stepper.polynomials, arena, options->degree,
                                 step->nodes.lane_count);
    tvi_galerkin_allocate_predictor(&stepper, arena);
    step->move = tvi_arena_allocate_doubles(arena, unknowns);
    step->move_low = tvi_arena_allocate_doubles(arena, unknowns);
    stepper.increment_scale = tvi_arena_allocate_doubles(arena, 2 * (size_t)system->n);
    stepper.rate_scale = tvi_arena_allocate_doubles(arena, unknowns);
    stepper.rate_row = tvi_arena_allocate(arena, unknowns * sizeof(int));
    allocate_tail(&step->tail, arena, system, step->nodes.scale);
    tvi_galerkin_allocate_form(&stepper, arena);
    tvi_galerkin_allocate_probe(&stepper, arena);
    if (taken) *taken = stepper;
    return taken;
}

static void set_tables(void *work)
{
    galerkin_stepper *stepper = work;
    galerkin_step *step = &stepper->step;
    tvi_galerkin_compute_tables(&stepper->coefficients, &stepper->polynomials, step->is_separable);
    step->c = stepper->coefficients.c;
    step->sum_weights = (galerkin_sum_weights){stepper->coefficients.one_minus_c, stepper->coefficients.last_term};
    step->nodes.nu = stepper->coefficients.nu;
    step->tail.inverse_end_weight = 1 / stepper->coefficients.b[0];
    step->rate_row = stepper->rate_row;
    step->probe = &stepper->probe;
    step->rule = tvi_galerkin_passes_rule(stepper);
    tvi_galerkin_set_form(stepper);
    tvi_galerkin_set_predictor(stepper);
    stepper->generated_steps =
        step->system->code && stepper->options->passes != TVI_PREDICT_ONLY ? step->system->code->generated_steps : NULL;
}

/* ---- The start of a step ----------------------------------------------------------------------------------------- */

static void set_step_size(galerkin_stepper *stepper, double h)
{
    galerkin_step *step = &stepper->step;
    const galerkin_nodes *nodes = &step->nodes;
    const tvi_system *system = step->system;
    if (h == step->h) return;
    step->h = h;
    for (int i = 0; i < nodes->lane_count; i++) nodes->hb[i] = h * stepper->coefficients.b[i];
    for (int u = 0; u < nodes->unknown_count; u++) {
        stepper->rate_scale[u] = 1 / h;
        nodes->scale[u] = step->is_separable                                    ? h / system->mass[u]
                          : u < stepper->n || step->form == GALERKIN_LAGRANGIAN ? 1
                                                                                : -1;
    }
    for (int i = 0; i < stepper->n; i++) {
        step->tail.inverse_scale[i] = 1 / fabs(nodes->scale[i]);
        nodes->m_over_h[i] = system->has_masses ? system->mass[i] / fabs(h) : INFINITY;
        stepper->increment_scale[i] = nodes->scale[i];
        stepper->increment_scale[stepper->n + i] = step->is_separable ? 1 : nodes->scale[stepper->n + i];
    }
}

/* Writes the times of the nodes of a step of size h into the block of the field's tape, if the tape uses the time. */
static void set_node_times(const galerkin_stepper *stepper, const tvi_step_origin *origin, double h)
{
    const galerkin_step *step = &stepper->step;
    double t[GALERKIN_MAX_LANES];
    if (!step->system->uses_time) return;
    for (int i = 0; i < step->nodes.lane_count; i++) t[i] = origin->t + (origin->t_low + h * step->c[i]);
    tvi_system_write_time(step->system, stepper->tape_block, step->nodes.lane_count, t);
}

/* Predicts the unknowns of a step that has no earlier step of the same size: from the last step, of which the new step
 * begins at the fraction *elapsed, or from the field at the start if elapsed is NULL. */
static tvi_status predict_first_step(galerkin_stepper *stepper, const tvi_step_origin *origin, const double *elapsed,
                                     tvi_stats *stats)
{
    galerkin_step *step = &stepper->step;
    /* The prediction needs the place of the impulses and the drift, which galerkin_make_steps will set again. */
    step->nodes.impulse = galerkin_ring_at(step, (int)stepper->predictor.history->ring_index + 1);
    galerkin_set_drift(step, origin);
    if (elapsed) {
        tvi_galerkin_predict_resized(stepper, *elapsed);
        return TVI_OK;
    }
    set_node_times(stepper, origin, 0);
    stats->force_evaluations++;
    return tvi_galerkin_predict_from_start(stepper, origin);
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

void tvi_galerkin_move(const galerkin_step *step)
{
    if (step->form == GALERKIN_LAGRANGIAN) lagrangian_move_q_and_p(step->lagrangian, &step->nodes, step->rate_row);
    else (void)nodes_move(&step->nodes, step->nodes.x, step->rate_row, NULL);
}

void tvi_galerkin_predict(const galerkin_step *step, const galerkin_extrapolation *by) { galerkin_predict(step, by); }

tvi_status tvi_galerkin_make_pass(const galerkin_step *step, double *movement, galerkin_counts *counts)
{
    return galerkin_make_pass(step, movement, counts);
}

void tvi_galerkin_evaluate(const galerkin_curve_points *at, const double *table, const double *L, double *out)
{
    galerkin_evaluate(at, table, L, out);
}

/* Makes steps by generated code if by_code is set, otherwise by the library. The first step is predicted from earlier
 * steps if may_extrapolate is set and the last step is near enough, otherwise from its start alone. */
static galerkin_outcome make_steps(galerkin_stepper *stepper, bool by_code, bool may_extrapolate,
                                   const tvi_run_request *run, const tvi_step_origin *origin,
                                   const tvi_run_state *state, tvi_stats *stats)
{
    const double h = run->h;
    galerkin_history *history = stepper->predictor.history;
    galerkin_outcome outcome = {.ring_index = (int)history->ring_index, .largest_tail = stats->largest_tail};
    double elapsed;
    set_step_size(stepper, h);
    if (h == history->last_h) outcome.convergence = history->convergence;
    if (may_extrapolate) outcome.is_extrapolated = tvi_galerkin_can_predict(stepper, origin->t, &elapsed);
    if (outcome.is_extrapolated && elapsed == 1 && h == history->last_h)
        outcome.equal_step_count = h == history->previous_h ? 2 : 1;
    if (outcome.equal_step_count == 0)
        outcome.status = predict_first_step(stepper, origin, outcome.is_extrapolated ? &elapsed : NULL, stats);
    if (outcome.status != TVI_OK) return outcome;
    set_node_times(stepper, origin, h);
    if (by_code) stepper->generated_steps->make_steps(&stepper->step, run, origin, state, &outcome);
    else galerkin_make_steps(&stepper->step, run, origin, state, &outcome);
    const galerkin_counts *made = outcome.step_count > 0 ? &outcome.counts_of_added : &outcome.counts;
    stats->passes += made->passes;
    stats->force_evaluations += made->evaluations;
    stats->factorisations += made->factorisations;
    if (outcome.step_count < 1) return outcome;
    *history = (galerkin_history){.last_h = h,
                                  .previous_h = outcome.step_count > 1 ? h : history->last_h,
                                  .last_t = outcome.start_time,
                                  .convergence = outcome.convergence,
                                  .ring_index = outcome.ring_index};
    stats->residual = sqrt(outcome.last_movement);
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
    const bool iterates = stepper->step.rule.max_passes > 0;
    galerkin_outcome outcome = {.step_count = 0};
    if (stepper->generated_steps) outcome = make_steps(stepper, true, true, &run, origin, NULL, stats);
    if (outcome.step_count < 1) outcome = make_steps(stepper, false, iterates, &run, origin, NULL, stats);
    if (outcome.step_count < 1 && outcome.is_extrapolated)
        outcome = make_steps(stepper, false, false, &run, origin, NULL, stats);
    return outcome.step_count > 0 ? TVI_OK : outcome.status;
}

static long make_steps_of_run(void *work, const tvi_run_request *run, const tvi_run_state *state, tvi_stats *stats)
{
    galerkin_stepper *stepper = work;
    const int n = stepper->n;
    const tvi_step_origin origin = {state->q[n], state->q_low[n], state->q, state->q_low, state->p, state->p_low};
    tvi_stats counted = *stats;
    if (stepper->step.rule.max_passes < 1 || stepper->step.system->uses_time) return 0;
    const galerkin_outcome outcome =
        make_steps(stepper, stepper->generated_steps != NULL, true, run, &origin, state, &counted);
    if (outcome.step_count < 1) return 0;
    *stats = counted;
    stats->largest_tail = outcome.largest_tail;
    return outcome.step_count;
}

/* ---- The curve of the last step ---------------------------------------------------------------------------------- */

/* Computes x [components][points], the components of the range at the fractions theta of the step: the polynomial of
 * degree m - 1 through the rates, integrated. `integral` [lanes][points] has the integrals of l_j / b_j from 0 to theta
 * (tables.h), or the double integrals for the positions of a separable system. */
static void integrate_impulses(const galerkin_stepper *stepper, tvi_component_range range, int points,
                               const double theta[], const double *integral, const double *L, const double *start,
                               const double *move, const double *scale, double *x)
{
    const int lanes = stepper->step.nodes.lane_count, from = range.first;
    const galerkin_curve_points at = {lanes, points, range.end - from, theta, start + from, move + from, scale + from};
    if (at.count > 0) galerkin_evaluate(&at, integral, L + from * lanes, x + from * points);
}

/* Computes the components used[0] of q and used[1] of p at the fractions theta of the step, [n][points] each. */
static void evaluate_curve(const galerkin_stepper *stepper, const tvi_component_range used[2], int points,
                           const double theta[], const double *single, const double *twice, const double q_start[],
                           const double p_start[], double *q, double *p)
{
    const galerkin_step *step = &stepper->step;
    const double *L = galerkin_ring_at(step, (int)stepper->predictor.history->ring_index);
    const double *of_p = L + (step->is_separable ? 0 : stepper->n * step->nodes.lane_count);
    integrate_impulses(stepper, used[0], points, theta, step->is_separable ? twice : single, L, q_start, step->move,
                       stepper->increment_scale, q);
    integrate_impulses(stepper, used[1], points, theta, single, of_p, p_start, stepper->predictor.zeros,
                       stepper->increment_scale + stepper->n, p);
}

static void interpolate(void *work, double theta, double dq[], double dp[])
{
    const galerkin_stepper *stepper = work;
    const tvi_component_range all[] = {{0, stepper->n}, {0, stepper->n}};
    double single[GALERKIN_MAX_LANES] = {0}, twice[GALERKIN_MAX_LANES] = {0};
    tvi_galerkin_integrate(&stepper->polynomials, theta, single, twice);
    evaluate_curve(stepper, all, 1, &theta, single, twice, stepper->predictor.zeros, stepper->predictor.zeros, dq, dp);
}

static void sample(void *work, const tvi_component_range used[2], const double q_start[], const double p_start[],
                   double *q, double *p)
{
    const galerkin_stepper *stepper = work;
    evaluate_curve(stepper, used, TVI_SAMPLES, tvi_sample_theta, stepper->polynomials.to_samples,
                   stepper->polynomials.twice_to_samples, q_start, p_start, q, p);
}

/* ---- Generated code ---------------------------------------------------------------------------------------------- */

static void emit_steps(jet_text *text, const tvi_system *system, const tvi_options *options)
{
    tvi_arena arena = {0};
    (void)allocate_stepper(&arena, system, options);
    void *memory = tvi_arena_obtain_memory(&arena);
    galerkin_stepper *stepper = memory ? allocate_stepper(&arena, system, options) : NULL;
    text->is_incomplete |= !stepper;
    if (!stepper) return;
    set_tables(stepper);
    tvi_galerkin_emit_steps(text, stepper);
    free(memory);
}

static tvi_tapes_of_steps list_tapes(const tvi_system *system, const tvi_options *options)
{
    const int lanes = choose_lane_count(options->degree);
    tvi_tapes_of_steps used = {.value_tape_emission = {.name_prefix = "tvi_values", .value_lane_counts = {lanes}},
                               .emit_steps = emit_steps};
    if (system->hessian_values)
        used.hessian_tape_emission = (jet_emission_request){.name_prefix = "tvi_hessian", .value_lane_counts = {lanes}};
    return used;
}

static bool is_history_valid(const void *work)
{
    const long index = ((const galerkin_stepper *)work)->predictor.history->ring_index;
    return index >= 0 && index < GALERKIN_RING_LENGTH;
}

const tvi_stepper tvi_stepper_galerkin = {.allocate = allocate_stepper,
                                          .set_tables = set_tables,
                                          .step = make_single_step,
                                          .run = make_steps_of_run,
                                          .interpolate = interpolate,
                                          .sample = sample,
                                          .is_superconvergent = true,
                                          .is_history_valid = is_history_valid,
                                          .list_tapes = list_tapes};
