/* galerkin.c - Makes the steps of the Galerkin curve by steps.h, for any system, or by generated steps for one: sets
 * the weights of a step, chooses its prediction, and keeps the history. The table at the end is the stepper of
 * "galerkin", of which there is one for each instruction set. Here h is the size of the step, and the other letters are
 * those of nodes.h. */
#include "galerkin/galerkin.h"
#include "compiled/code.h"

#include <stdlib.h>

/* ---- Memory and tables ------------------------------------------------------------------------------------------- */

int tvi_galerkin_lane_count(int node_count) { return node_count <= 4 ? 4 : node_count <= 8 ? 8 : GALERKIN_MAX_LANES; }

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
    nodes->lane_count = tvi_galerkin_lane_count(node_count);
    nodes->unknown_count = system->input_count;
    nodes->n = system->n;
    nodes->moving_count = cyclic > 0 ? system->n - cyclic : nodes->unknown_count;
    nodes->subsystems = system->subsystems;
    const size_t unknowns = (size_t)nodes->unknown_count, lanes = (size_t)nodes->lane_count;
    nodes->free_motion = tvi_arena_allocate_doubles(arena, unknowns * lanes);
    nodes->free_motion_low = tvi_arena_allocate_doubles(arena, unknowns * lanes);
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
    tail->has_masses = system->tail.has_shares_without_momenta;
    tail->subsystems = system->tail.subsystems;
    tail->scale = scale;
    tail->inverse_scale = tvi_arena_allocate_doubles(arena, (size_t)system->n);
    tail->share = tvi_arena_allocate_doubles(arena, (size_t)system->n);
    tail->ratio = tvi_arena_allocate_doubles(arena, (size_t)system->n);
}

static void *allocate_work(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    galerkin_work *taken = tvi_arena_allocate(arena, sizeof *taken);
    galerkin_work work = {.options = options, .n = system->n};
    galerkin_step *step = &work.step;
    step->system = system;
    step->is_separable = system->form == TVI_SEPARABLE;
    allocate_nodes(&step->nodes, arena, system, options->degree);
    const size_t unknowns = (size_t)step->nodes.unknown_count;
    tvi_galerkin_allocate_tables(&work.coefficients, &work.polynomials, arena, options->degree, step->nodes.lane_count);
    tvi_galerkin_allocate_predictor(&work, arena);
    step->move = tvi_arena_allocate_doubles(arena, unknowns);
    step->move_low = tvi_arena_allocate_doubles(arena, unknowns);
    work.increment_scale = tvi_arena_allocate_doubles(arena, 2 * (size_t)system->n);
    work.rate_scale = tvi_arena_allocate_doubles(arena, unknowns);
    work.lists.rate_row = tvi_arena_allocate(arena, unknowns * sizeof(int));
    allocate_tail(&step->tail, arena, system, step->nodes.scale);
    tvi_galerkin_allocate_form(&work, arena);
    tvi_galerkin_allocate_probe(&work, arena);
    if (taken) *taken = work;
    return taken;
}

static void set_tables(void *self)
{
    galerkin_work *work = self;
    galerkin_step *step = &work->step;
    tvi_galerkin_compute_tables(&work->coefficients, &work->polynomials, step->is_separable);
    step->c = work->coefficients.c;
    step->sum_weights = (galerkin_sum_weights){work->coefficients.one_minus_c, work->coefficients.last_term};
    step->nodes.nu = work->coefficients.nu;
    step->tail.inverse_end_weight = 1 / work->coefficients.b[0];
    step->rate_row = work->lists.rate_row;
    step->probe = &work->probe;
    step->rule = tvi_galerkin_make_stopping_rule(work);
    tvi_galerkin_set_form(work);
    tvi_galerkin_set_predictor(work);
    /* The code of a system is attached by compiled/attach.c. */
    work->generated_steps =
        step->system->code && work->options->passes != TVI_PREDICT_ONLY ? step->system->code->generated_steps : NULL;
}

/* ---- The start of a step ----------------------------------------------------------------------------------------- */

void tvi_galerkin_set_step_size(galerkin_work *work, double h)
{
    galerkin_step *step = &work->step;
    const galerkin_nodes *nodes = &step->nodes;
    const tvi_system *system = step->system;
    if (h == step->h) return;
    step->h = h;
    for (int i = 0; i < nodes->lane_count; i++) nodes->hb[i] = h * work->coefficients.b[i];
    for (int u = 0; u < nodes->unknown_count; u++) {
        work->rate_scale[u] = 1 / h;
        nodes->scale[u] = step->is_separable                                 ? h / system->mass[u]
                          : u < work->n || step->form == GALERKIN_LAGRANGIAN ? 1
                                                                             : -1;
    }
    for (int i = 0; i < work->n; i++) {
        step->tail.inverse_scale[i] = 1 / fabs(nodes->scale[i]);
        nodes->m_over_h[i] = system->has_masses ? system->mass[i] / fabs(h) : INFINITY;
        work->increment_scale[i] = nodes->scale[i];
        work->increment_scale[work->n + i] = step->is_separable ? 1 : nodes->scale[work->n + i];
    }
}

/* Writes the times of the nodes of a step of size h into the block of the field's tape, if the tape uses the time. */
void tvi_galerkin_set_node_times(const galerkin_work *work, const tvi_step_origin *origin, double h)
{
    const galerkin_step *step = &work->step;
    double t[GALERKIN_MAX_LANES];
    if (!step->system->uses_time) return;
    for (int i = 0; i < step->nodes.lane_count; i++) t[i] = origin->t + (origin->t_low + h * step->c[i]);
    tvi_system_write_time(step->system, work->tape_block, step->nodes.lane_count, t);
}

/* Sets `count` rows of nodes.x, from row `first` on, to one number each. */
static void fill_rows(const galerkin_nodes *nodes, int first, int count, const double value[])
{
    for (int i = 0; i < count; i++)
        for (int lane = 0; lane < nodes->lane_count; lane++)
            nodes->x[(first + i) * nodes->lane_count + lane] = value[i];
}

/* Moves the unknowns by the rates in the rows of nodes.x. */
static void move_by_rates(const galerkin_step *step)
{
    if (step->form == GALERKIN_LAGRANGIAN) lagrangian_move_by_rates(step->lagrangian, &step->nodes, step->rate_row);
    else (void)nodes_move_by_rates(&step->nodes, step->nodes.x, step->rate_row, NULL);
}

/* Predicts the unknowns from the start of the step alone, whose size does not enter the rates: the field at the start
 * gives the rates at all nodes, and the unknowns move by them. The velocity of a Lagrangian is that of the Legendre
 * transform at the start, whose iteration begins with 0. */
tvi_status tvi_galerkin_predict_from_start(galerkin_work *work, const tvi_step_origin *origin)
{
    const galerkin_step *step = &work->step;
    const galerkin_nodes *nodes = &step->nodes;
    const int n = nodes->n, lanes = nodes->lane_count;
    const double *second = nodes->x + n * lanes, *block;
    fill_rows(nodes, 0, nodes->unknown_count, nodes->start);
    if (step->form == GALERKIN_PLAIN) {
        if (!galerkin_sweep(&step->field, false)) return TVI_EDOMAIN;
        move_by_rates(step);
        return TVI_OK;
    }
    if (step->form == GALERKIN_LAGRANGIAN) {
        double *v = work->start_velocity;
        memset(v, 0, (size_t)n * sizeof *v);
        const tvi_status status = tvi_legendre_solve(&work->legendre, origin->t, origin->q, origin->p, v);
        if (status != TVI_OK) return status;
        fill_rows(nodes, 2 * n, n, v);
        second = nodes->x + 2 * n * lanes;
    } else step->hamiltonian->last_movement = INFINITY;
    if (!(block = galerkin_evaluate_gradient_at(&step->field, false, nodes->x, second))) return TVI_EDOMAIN;
    /* The rows of V are there already; those of F are L_q, the first n components of the gradient. */
    const int first = step->form == GALERKIN_LAGRANGIAN ? n : 0;
    for (int u = first; u < nodes->unknown_count; u++)
        memcpy(nodes->x + step->rate_row[u] * lanes, block + step->field.slot[false][u - first] * lanes,
               (size_t)lanes * sizeof *block);
    move_by_rates(step);
    return TVI_OK;
}

/* Predicts the unknowns of a step that has no earlier step of the same size: from the last step, of which the new step
 * begins at the fraction *elapsed, or from the field at the start if elapsed is NULL. */
static tvi_status predict_without_equal_step(galerkin_work *work, const tvi_step_origin *origin, const double *elapsed,
                                             tvi_stats *stats)
{
    galerkin_step *step = &work->step;
    /* The prediction needs the place of the impulses and the free motion, which galerkin_make_steps will set again. */
    step->nodes.impulse = galerkin_ring_at(step, (int)work->predictor.history->ring_index + 1);
    galerkin_set_free_motion(step, origin);
    if (elapsed) {
        const galerkin_extrapolation by = tvi_galerkin_resize_last_step(work, *elapsed);
        galerkin_predict(step, &by);
        return TVI_OK;
    }
    tvi_galerkin_set_node_times(work, origin, 0);
    stats->force_evaluations++;
    return tvi_galerkin_predict_from_start(work, origin);
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

tvi_status tvi_galerkin_make_pass(const galerkin_step *step, double *movement, galerkin_counts *counts)
{
    return galerkin_make_pass(step, movement, counts);
}

/* Makes generated steps if is_generated is set, and otherwise steps by the library. The first step is predicted from
 * earlier steps if may_extrapolate is set and the last step is near enough, otherwise from its start alone. */
static galerkin_outcome make_steps(galerkin_work *work, bool is_generated, bool may_extrapolate,
                                   const tvi_run_request *run, const tvi_step_origin *origin,
                                   const tvi_run_state *state, tvi_stats *stats)
{
    const double h = run->h;
    galerkin_history *history = work->predictor.history;
    galerkin_outcome outcome = {.ring_index = (int)history->ring_index, .largest_tail = stats->largest_tail};
    double elapsed;
    tvi_galerkin_set_step_size(work, h);
    if (h == history->last_h) outcome.convergence = history->convergence;
    /* The last step can predict the next one, except in the first step of a run or if the step is much larger. */
    if (may_extrapolate) outcome.is_extrapolated = tvi_galerkin_can_predict(work, origin->t, &elapsed);
    if (outcome.is_extrapolated && elapsed == 1 && h == history->last_h)
        outcome.equal_step_count = h == history->previous_h ? 2 : 1;
    if (outcome.equal_step_count == 0)
        outcome.status = predict_without_equal_step(work, origin, outcome.is_extrapolated ? &elapsed : NULL, stats);
    if (outcome.status != TVI_OK) return outcome;
    tvi_galerkin_set_node_times(work, origin, h);
    /* .make_steps is galerkin_make_generated_steps of generated.h. */
    if (is_generated) work->generated_steps->make_steps(&work->step, run, origin, state, &outcome);
    else galerkin_make_steps(&work->step, run, origin, state, &outcome);
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
static tvi_status make_single_step(void *self, double h, const tvi_step_origin *origin,
                                   const tvi_increments *increments, tvi_stats *stats)
{
    galerkin_work *work = self;
    const tvi_run_request run = {
        .h = h, .max_steps = 1, .index_of_time_in_q = -1, .last_step_increments_out = *increments};
    const bool iterates = work->step.rule.max_passes > 0;
    galerkin_outcome outcome = {.step_count = 0};
    if (work->generated_steps) outcome = make_steps(work, true, iterates, &run, origin, NULL, stats);
    if (outcome.step_count < 1) outcome = make_steps(work, false, iterates, &run, origin, NULL, stats);
    if (outcome.step_count < 1 && outcome.is_extrapolated)
        outcome = make_steps(work, false, false, &run, origin, NULL, stats);
    return outcome.step_count > 0 ? TVI_OK : outcome.status;
}

static long make_steps_of_run(void *self, const tvi_run_request *run, const tvi_run_state *state, tvi_stats *stats)
{
    galerkin_work *work = self;
    const int n = work->n;
    const tvi_step_origin origin = {state->q[n], state->q_low[n], state->q, state->q_low, state->p, state->p_low};
    tvi_stats counted = *stats;
    if (work->step.rule.max_passes < 1 || work->step.system->uses_time) return 0;
    const galerkin_outcome outcome =
        make_steps(work, work->generated_steps != NULL, true, run, &origin, state, &counted);
    if (outcome.step_count < 1) return 0;
    *stats = counted;
    stats->largest_tail = outcome.largest_tail;
    return outcome.step_count;
}

/* ---- Generated steps --------------------------------------------------------------------------------------------- */

/* Writes the generated steps for compiled/compile.c. A stepper is made for them, since it has the lists and the rule.
 */
static void emit_steps(jet_text *text, const tvi_system *system, const tvi_options *options)
{
    tvi_arena arena = {0};
    (void)allocate_work(&arena, system, options);
    void *memory = tvi_arena_obtain_memory(&arena);
    galerkin_work *work = memory ? allocate_work(&arena, system, options) : NULL;
    text->is_incomplete |= !work;
    if (!work) return;
    set_tables(work);
    tvi_galerkin_emit_steps(text, work);
    free(memory);
}

static tvi_tapes_of_steps list_tapes(const tvi_system *system, const tvi_options *options)
{
    const int lanes = tvi_galerkin_lane_count(options->degree);
    const char *hessian = system->hessian.values ? GALERKIN_HESSIAN_TAPE : NULL;
    return (tvi_tapes_of_steps){
        .value_tape_emission = {.name_prefix = GALERKIN_VALUES_TAPE, .value_lane_counts = {lanes}},
        .hessian_tape_emission = {.name_prefix = hessian, .value_lane_counts = {lanes}},
        .emit_steps = emit_steps};
}

static bool is_history_valid(const void *self)
{
    const long index = ((const galerkin_work *)self)->predictor.history->ring_index;
    return index >= 0 && index < GALERKIN_RING_LENGTH;
}

const tvi_stepper tvi_stepper_galerkin = {.allocate = allocate_work,
                                          .set_tables = set_tables,
                                          .step = make_single_step,
                                          .run = make_steps_of_run,
                                          .compute_curve_forces = tvi_galerkin_curve_forces,
                                          .interpolate = tvi_galerkin_interpolate,
                                          .sample = tvi_galerkin_sample,
                                          .quadrature = tvi_galerkin_quadrature,
                                          .at_nodes = tvi_galerkin_at_nodes,
                                          .is_superconvergent = true,
                                          .is_history_valid = is_history_valid,
                                          .list_tapes = list_tapes};
