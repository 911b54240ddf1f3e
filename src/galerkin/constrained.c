/* constrained.c - Makes the steps of the Galerkin curve on constraints phi(q, t) = 0 (docs/method.md, section 12): the
 * (m, m)-Gauss-Lobatto SPARK method of Jay. Forces act at the m Gauss nodes, as in galerkin.c, whose memory, passes and
 * sums this file uses; constraints act at m + 1 Lobatto nodes by impulses K_j (constraint_nodes.h), of which the field
 * knows only what they add to the free motion of the unknowns. The table at the end is the stepper of "galerkin" for a
 * system with constraints. The plain step knows nothing of it. */
#include "galerkin/constrained.h"
#include "refusal.h"

#include <math.h>

/* [1] The factor of S is computed anew in a pass whose predecessor moved the unknowns by more than this part. A factor
 * that is off by it corrects all but this part of an error, as the iterations of a pass do. */
#define CONSTRAINT_FACTOR_MAX_MOVEMENT 1e-4
/* [1] A pass is expected to leave at least this part of the error, although constraints, whose errors the first passes
 * show, converge faster than forces. */
#define CONSTRAINT_LEAST_CONTRACTION 1e-3 /* found: make constraints */
/* [1] A predicted step with a larger tail is made again from its start. Results with such tails are called doubtful
 * (docs/stability.md). */
#define CONSTRAINT_DOUBTFUL_TAIL 1e-2
/* [1], [passes] Movements of at most this part that no longer shrink are roundoff after so many passes. */
#define CONSTRAINT_ROUNDOFF        (256 * DBL_EPSILON) /* found: make constraints */
#define CONSTRAINT_ROUNDOFF_PASSES 4                   /* found: make constraints */

/* ---- Memory and tables ------------------------------------------------------------------------------------------- */

/* Finds the first constraint that shares a coordinate with constraint k. */
static int first_neighbour(const tvi_constraints *c, bool has_masses, int k)
{
    if (!has_masses) return 0;
    for (int l = 0; l < k; l++)
        for (int e = constraint_row_begin(c, k); e < c->row_end[k]; e++)
            for (int f = constraint_row_begin(c, l); f < c->row_end[l]; f++)
                if (c->column[e] == c->column[f]) return l;
    return k;
}

static void allocate_constraint_nodes(constraint_nodes *at, tvi_arena *arena, const tvi_system *system, int lane_count)
{
    const tvi_constraints *c = at->constraints = system->constraints;
    const size_t n = (size_t)system->n, m = (size_t)c->count, lanes = (size_t)lane_count;
    at->n = system->n;
    at->count = c->count;
    at->has_masses = system->has_masses;
    at->hW = tvi_arena_allocate_doubles(arena, at->has_masses ? n : n * n);
    at->W = tvi_arena_allocate_doubles(arena, at->has_masses ? n : n * n);
    at->S.first = tvi_arena_allocate(arena, m * sizeof *at->S.first);
    at->S.row_begin = tvi_arena_allocate(arena, m * sizeof *at->S.row_begin);
    at->S.size = 0;
    for (int k = 0; k < at->count; k++) {
        const int first = first_neighbour(c, at->has_masses, k);
        if (at->S.first) {
            at->S.first[k] = first;
            at->S.row_begin[k] = at->S.size;
        }
        at->S.size += k - first + 1;
    }
    const size_t factor = (size_t)at->S.size, entries = (size_t)c->entry_count;
    at->multiplier_of_entry = tvi_arena_allocate(arena, entries * sizeof *at->multiplier_of_entry);
    at->momentum_of_entry = tvi_arena_allocate(arena, entries * sizeof *at->momentum_of_entry);
    for (int k = 0, e = 0; k < at->count && at->multiplier_of_entry && at->momentum_of_entry; k++)
        for (; e < c->row_end[k]; e++) {
            at->multiplier_of_entry[e] = tvi_constraint_multiplier(c, k);
            at->momentum_of_entry[e] = tvi_constraint_momentum(c, at->n, c->column[e]);
        }
    at->pass.values = tvi_arena_allocate_block(arena, c->values, 1, lane_count, 0);
    at->pass.curvature = tvi_arena_allocate_block(arena, c->curvature, 1, lane_count, 0);
    tvi_arena_allocate_each(arena, factor * lanes, (double **[]){&at->S.targets, &at->S.sources, NULL});
    tvi_arena_allocate_each(arena, entries * lanes, (double **[]){&at->G.targets, &at->G.sources, NULL});
    tvi_arena_allocate_each(arena, m * lanes, (double **[]){&at->mu, &at->pass.phi, &at->pass.residual, NULL});
    tvi_arena_allocate_each(arena, n * lanes,
                            (double **[]){&at->K, &at->X.free, &at->X.free_low, &at->X.now, &at->X.moved,
                                          &at->X.by_forces, &at->pass.rest, &at->pass.bent, &at->pass.turn,
                                          &at->pass.scratch, NULL});
    at->X.end_roundoff = tvi_arena_allocate_doubles(arena, n);
    at->S.start = tvi_arena_allocate_doubles(arena, factor);
    at->G.start = tvi_arena_allocate_doubles(arena, entries);
}

static void allocate_one_state(constrained_work *work, tvi_arena *arena, const tvi_system *system, int lanes)
{
    const tvi_constraints *c = system->constraints;
    const size_t n = (size_t)system->n;
    tvi_constraint_allocate(&work->one, arena, system);
    work->values = tvi_arena_allocate_block(arena, c->values, 1, 1, 0);
    work->bend = tvi_arena_allocate_block(arena, c->curvature, 1, lanes, 0);
    work->G = tvi_arena_allocate_doubles(arena, (size_t)c->entry_count);
    work->S = tvi_arena_allocate_doubles(arena, (size_t)work->nodes.S.size);
    tvi_arena_allocate_each(arena, n,
                            (double **[]){&work->q, &work->q_low, &work->p, &work->p_low, &work->v, &work->K, NULL});
    work->lambda = tvi_arena_allocate_doubles(arena, (size_t)c->count);
}

static void *allocate_work(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    constrained_work *taken = tvi_arena_allocate(arena, sizeof *taken);
    constrained_work work = {.galerkin = tvi_stepper_galerkin.allocate(arena, system, options)};
    const int m = options->degree, lane_count = tvi_galerkin_lane_count(m);
    const size_t lanes = (size_t)lane_count, n = (size_t)system->n, nodes = (size_t)m + 1;
    tvi_lobatto_allocate(&work.tables, arena, m, lane_count);
    allocate_constraint_nodes(&work.nodes, arena, system, lane_count);
    for (int i = 0; i < GALERKIN_RING_LENGTH; i++) {
        const size_t count = (size_t)system->constraints->count;
        work.ring[i].lambda = tvi_arena_allocate_uncopied(arena, count * nodes * sizeof(double));
        work.ring[i].K = tvi_arena_allocate_uncopied(arena, n * nodes * sizeof(double));
    }
    work.low_without_impulses = tvi_arena_allocate_doubles(arena, (size_t)system->input_count * lanes);
    work.sum = tvi_arena_allocate_doubles(arena, n * lanes);
    work.fit[0] = tvi_arena_allocate_doubles(arena, 2 * lanes * lanes);
    work.fit[1] = tvi_arena_allocate_doubles(arena, lanes * lanes);
    allocate_one_state(&work, arena, system, lane_count);
    if (taken) *taken = work;
    return taken;
}

static void set_tables(void *self)
{
    constrained_work *work = self;
    galerkin_work *galerkin = work->galerkin;
    const int m = galerkin->step.nodes.node_count, lanes = galerkin->step.nodes.lane_count;
    double identity[GALERKIN_MAX_LANES * GALERKIN_MAX_LANES] = {0};
    tvi_stepper_galerkin.set_tables(galerkin);
    tvi_lobatto_compute(&work->tables, &galerkin->coefficients, galerkin->step.is_separable);
    work->nodes.tables = &work->tables;
    for (int j = 0; j < m; j++) identity[j * lanes + j] = 1;
    tvi_galerkin_extrapolation(&galerkin->coefficients, 2, m > 1 ? 3 * m / 2 : 1, identity, work->fit[0]);
    tvi_galerkin_extrapolation(&galerkin->coefficients, 1, m - 1, identity, work->fit[1]);
}

/* ---- Passes ------------------------------------------------------------------------------------------------------ */

/* Sets end_roundoff of a separable system, whose increment of q is summed exactly: X at the end of the step is to be
 * that q. */
static void set_end_roundoff(const constrained_work *work)
{
    const constraint_nodes *at = &work->nodes;
    const galerkin_step *step = &work->galerkin->step;
    const int m = work->tables.node_count, lanes = step->nodes.lane_count;
    for (int i = 0; i < at->n; i++) {
        double sum = 0, low = 0;
        for (int j = 0; j < m; j++) {
            constrained_add_product(work->galerkin->coefficients.one_minus_c[j], step->nodes.impulse[i * lanes + j],
                                    &sum, &low);
            constrained_add_product(work->tables.one_minus_d[j], at->K[i * lanes + j], &sum, &low);
        }
        const double rise = at->hW[i] * sum;
        at->X.end_roundoff[i] =
            (rise - at->X.moved[i * lanes + m - 1]) + (fma(at->hW[i], sum, -rise) + at->hW[i] * low);
    }
}

/* Makes a pass of the forces, then one of the constraints, and moves the unknowns by both. */
static tvi_status make_pass(constrained_work *work, double *movement, bool is_factor_new, galerkin_counts *counts)
{
    galerkin_step *step = &work->galerkin->step;
    const galerkin_nodes *nodes = &step->nodes;
    double of_forces = 0;
    if (step->form == GALERKIN_PLAIN) {
        counts->evaluations += nodes->node_count;
        if (!galerkin_sweep(&step->field, false)) return TVI_EDOMAIN;
        BY_LANES(lanes, nodes->lane_count, set_impulse_rows(nodes, nodes->x, step->rate_row, lanes));
    } else {
        const tvi_status status = tvi_galerkin_make_pass(step, &of_forces, counts);
        if (status == TVI_ESINGULAR) return jet_refuse(status, "L_vv is singular");
        if (status != TVI_OK) return status;
    }
    tvi_constrained_set_by_forces(work);
    const constraint_outcome of_constraints =
        constraint_pass(&work->nodes, nodes->lane_count, is_factor_new, nodes->inverse_size);
    counts->factorisations += is_factor_new ? nodes->node_count : 0;
    if (!of_constraints.is_inside) return TVI_EDOMAIN;
    if (isnan(of_constraints.pivot)) return TVI_ENONFINITE;
    if (!(of_constraints.pivot > tvi_dependent_pivot(work->nodes.count)))
        return tvi_refuse_dependent(of_constraints.least, of_constraints.pivot);
    tvi_constrained_add_impulses(work);
    if (step->form == GALERKIN_PLAIN) {
        of_forces = constrained_move_unknowns(step);
        counts->passes++;
    }
    *movement = of_forces + of_constraints.movement;
    if (step->is_separable) set_end_roundoff(work);
    return isfinite(*movement) ? TVI_OK : TVI_ENONFINITE;
}

/* Sets the sizes of the unknowns. Forces and impulses of constraint may cancel each other, as across a line along which
 * a bead moves: the roundoff of their sums counts in the sizes of what they move. */
static void set_sizes(const constrained_work *work)
{
    const constraint_nodes *at = &work->nodes;
    const galerkin_nodes *nodes = &work->galerkin->step.nodes;
    const int n = at->n, lanes = nodes->lane_count;
    double *impulse = work->sum;
    nodes_set_sizes(nodes);
    for (int i = 0; i < n; i++) {
        impulse[i] = 0;
        for (int j = 0; j < work->tables.node_count; j++) impulse[i] += fabs(at->K[i * lanes + j]);
        if (nodes->unknown_count > n) nodes->inverse_size[n + i] = 1 / (1 / nodes->inverse_size[n + i] + impulse[i]);
    }
    for (int i = 0; i < n; i++) {
        double moved = at->has_masses ? fabs(at->hW[i]) * impulse[i] : 0;
        for (int j = 0; j < (at->has_masses ? 0 : n); j++) moved += fabs(at->hW[i * n + j]) * impulse[j];
        nodes->inverse_size[i] = 1 / (1 / nodes->inverse_size[i] + moved);
    }
}

/* Tells whether passes that may end by the rule may do so although constraints, whose errors the first passes show,
 * contract faster than forces. */
static bool may_end(const tvi_convergence_test *test, const tvi_stopping_rule *rule)
{
    const double least = CONSTRAINT_LEAST_CONTRACTION * CONSTRAINT_LEAST_CONTRACTION;
    return rule->exact_passes > 0 || test->size == test->previous_size ||
           least * test->size_without_roundoff <= rule->correction_goal;
}

/* Gives the components of a lift's tangent vector the sizes of what their roundoff is of: that of a coordinate has the
 * roundoff of the coordinate, and a momentum what moves coordinates by their roundoff in the step. The column was
 * scaled to the size of the state (integrator/tangent.c), but some of its components may be small, or all of a
 * parameter that moves nothing. */
static void raise_sizes_of_vector(const constrained_work *work)
{
    const galerkin_nodes *nodes = &work->galerkin->step.nodes;
    const int n = nodes->n;
    double *const inverse = nodes->inverse_size, least = inverse[0];
    for (int i = 0; i < n / 2; i++) {
        least = tvi_smaller(least, inverse[i]);
        inverse[n / 2 + i] = tvi_smaller(inverse[n / 2 + i], inverse[i]);
    }
    for (int j = n; j < nodes->unknown_count; j++) {
        const double moves = tvi_largest_magnitude(n, work->nodes.hW + j - n, n);
        inverse[j] = tvi_smaller(inverse[j], moves * least);
    }
}

static tvi_status make_passes(constrained_work *work, galerkin_convergence *convergence, double *movement,
                              galerkin_counts *counts)
{
    galerkin_step *step = &work->galerkin->step;
    const tvi_stopping_rule *rule = &step->rule;
    const double numbers = step->nodes.unknown_count * step->nodes.lane_count,
                 max_kept = numbers * CONSTRAINT_FACTOR_MAX_MOVEMENT * CONSTRAINT_FACTOR_MAX_MOVEMENT,
                 roundoff = numbers * CONSTRAINT_ROUNDOFF * CONSTRAINT_ROUNDOFF;
    tvi_convergence_test test;
    int stuck = 0;
    tvi_convergence_begin(&test, convergence->contraction);
    *movement = INFINITY;
    for (int made = 0; made < rule->max_passes; made++) {
        const tvi_status status = make_pass(work, movement, !(*movement <= max_kept), counts);
        if (status != TVI_OK) return status;
        const tvi_passes_verdict verdict = tvi_convergence_add_pass(&test, rule, *movement);
        if (made == 0) convergence->first_movement = *movement;
        convergence->contraction = test.slowest_ratio;
        if (verdict == TVI_PASSES_MAY_END && may_end(&test, rule)) return TVI_OK;
        if (verdict == TVI_PASSES_STUCK && *movement <= roundoff && ++stuck == CONSTRAINT_ROUNDOFF_PASSES)
            return TVI_OK;
        if (verdict == TVI_PASSES_STUCK && *movement > roundoff && work->nodes.constraints->is_lift)
            raise_sizes_of_vector(work);
        if (*movement > 1) set_sizes(work);
    }
    return TVI_ENOCONV;
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

static tvi_status make_step(constrained_work *work, double h, bool may_extrapolate, const tvi_step_origin *origin,
                            const tvi_increments *increments, bool *is_extrapolated, tvi_stats *stats)
{
    galerkin_work *galerkin = work->galerkin;
    galerkin_history *history = galerkin->predictor.history;
    galerkin_convergence convergence = {0};
    galerkin_counts counts = {0};
    double elapsed = 0, movement = 0, tail = 0, times[GALERKIN_MAX_LANES];
    const constraint_nodes *at = &work->nodes;
    const int lanes = galerkin->step.nodes.lane_count;
    tvi_galerkin_set_step_size(galerkin, h);
    const bool continues = may_extrapolate && h == history->last_h &&
                           tvi_galerkin_can_predict(galerkin, origin->t, &elapsed) && elapsed == 1;
    *is_extrapolated = continues;
    if (continues) convergence = history->convergence;
    tvi_status status = tvi_constrained_set_scales(work, h, origin);
    const bool was_near = convergence.first_movement <= galerkin->step.two_step_max_movement;
    const int equal_steps = !continues ? 0 : h == history->previous_h && was_near ? 2 : 1;
    if (status == TVI_OK) status = tvi_constrained_predict(work, origin, equal_steps, stats);
    if (status != TVI_OK) return status;
    tvi_galerkin_set_node_times(galerkin, origin, h);
    for (int lane = 0; lane < lanes; lane++) times[lane] = origin->t + (origin->t_low + h * work->tables.d[lane]);
    constrained_set_times(at->constraints->values, at->pass.values, at->n, lanes, times);
    constrained_set_times(at->constraints->curvature, at->pass.curvature, 2 * at->n + at->count, lanes, times);
    set_sizes(work);
    const int next = ((int)history->ring_index + 1) % GALERKIN_RING_LENGTH;
    status = make_passes(work, &convergence, &movement, &counts);
    if (status == TVI_OK) status = tvi_constrained_set_increments(work, origin, increments, &work->ring[next], &tail);
    stats->passes += counts.passes;
    stats->force_evaluations += counts.evaluations;
    stats->factorisations += counts.factorisations;
    if (status != TVI_OK) return status;
    *history = (galerkin_history){.last_h = h,
                                  .previous_h = history->last_h,
                                  .last_t = origin->t,
                                  .convergence = convergence,
                                  .ring_index = next};
    stats->residual = sqrt(movement);
    stats->tail = tail;
    return TVI_OK;
}

/* Makes a step, predicted from earlier steps. If the passes do not converge, or if the tail is so large that they may
 * have found another solution of the constraints than the one that is near, makes it again, predicted from its start.
 */
static tvi_status make_single_step(void *self, double h, const tvi_step_origin *origin,
                                   const tvi_increments *increments, tvi_stats *stats)
{
    constrained_work *work = self;
    galerkin_history *history = work->galerkin->predictor.history;
    const galerkin_history before = *history;
    bool is_extrapolated;
    const tvi_status status = make_step(work, h, true, origin, increments, &is_extrapolated, stats);
    if (!is_extrapolated || (status == TVI_OK && stats->tail <= CONSTRAINT_DOUBTFUL_TAIL)) return status;
    *history = before;
    return make_step(work, h, false, origin, increments, &is_extrapolated, stats);
}

static bool is_history_valid(const void *self)
{
    const constrained_work *work = self;
    return tvi_stepper_galerkin.is_history_valid(work->galerkin);
}

static tvi_tapes_of_steps list_tapes(const tvi_system *system, const tvi_options *options)
{
    const int lanes = tvi_galerkin_lane_count(options->degree);
    tvi_tapes_of_steps tapes = tvi_stepper_galerkin.list_tapes(system, options);
    tapes.emit_steps = NULL;
    tapes.constraint_tape_emission =
        (jet_emission_request){.name_prefix = "tvi_constraints", .value_lane_counts = {1, lanes}};
    tapes.curvature_tape_emission =
        (jet_emission_request){.name_prefix = "tvi_curvature", .value_lane_counts = {lanes}};
    return tapes;
}

const tvi_stepper tvi_stepper_constrained = {.allocate = allocate_work,
                                             .set_tables = set_tables,
                                             .step = make_single_step,
                                             .interpolate = tvi_constrained_interpolate,
                                             .sample = tvi_constrained_sample,
                                             .is_superconvergent = true,
                                             .is_history_valid = is_history_valid,
                                             .list_tapes = list_tapes};
