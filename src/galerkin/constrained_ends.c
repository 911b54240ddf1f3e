/* constrained_ends.c - Computes at both ends of a constrained step (constrained.c): the prediction from the start, the
 * impulse of the last node, the increments, and the curve in between. */
#include "galerkin/constrained.h"

#include <math.h>

/* The limit of the iteration for the last impulse of a step, which is not reached: it ends at roundoff. */
enum { CONSTRAINT_MAX_ROUNDS = 50 };

/* ---- One state --------------------------------------------------------------------------------------------------- */

/* Sets G [entries] at q + q_low: G at q, and its change by q_low, of which each lane computes one row. Returns false if
 * an operand is outside its domain. */
static bool set_G_of_state(constrained_work *work, double t, const double *q, const double *q_low, double *G)
{
    const constraint_nodes *at = &work->nodes;
    const tvi_constraints *c = at->constraints;
    const int n = at->n, m = at->count, lanes = work->galerkin->step.nodes.lane_count;
    double times[GALERKIN_MAX_LANES];
    for (int lane = 0; lane < lanes; lane++) times[lane] = t;
    memcpy(work->values, q, (size_t)n * sizeof *q);
    constrained_set_times(c->values, work->values, n, 1, times);
    if (!jet_sweep_values(c->values, work->values, 1)) return false;
    for (int e = 0; e < c->entry_count; e++) G[e] = work->values[c->values->output_slot[m + e]];
    constrained_set_times(c->curvature, work->bend, 2 * n + m, lanes, times);
    for (int i = 0; i < n; i++)
        for (int lane = 0; lane < lanes; lane++) {
            work->bend[i * lanes + lane] = q[i];
            work->bend[(n + i) * lanes + lane] = q_low[i];
        }
    for (int first = 0; first < m; first += lanes) {
        for (int k = 0; k < m; k++)
            for (int lane = 0; lane < lanes; lane++) work->bend[(2 * n + k) * lanes + lane] = k == first + lane;
        if (!jet_sweep_values(c->curvature, work->bend, lanes)) return false;
        for (int k = first; k < m && k < first + lanes; k++)
            for (int e = constraint_row_begin(c, k); e < c->row_end[k]; e++)
                G[e] += work->bend[c->curvature->output_slot[c->column[e]] * lanes + k - first];
    }
    return true;
}

/* Sets G = phi_q and the factor of S = G W G^T at q + q_low. */
static tvi_status set_factor_of_state(constrained_work *work, double t, const double *q, const double *q_low, double *G,
                                      double *S)
{
    int least = 0;
    if (!set_G_of_state(work, t, q, q_low, G)) return TVI_EDOMAIN;
    const double pivot = constraint_factor_S(&work->nodes, G, S, &least, 1);
    return pivot > tvi_dependent_pivot(work->nodes.count) ? TVI_OK : tvi_refuse_dependent(least, pivot);
}

/* ---- The start of a step ----------------------------------------------------------------------------------------- */

/* Sets W at a state. */
static tvi_status set_W(constrained_work *work, double t, const double *q, const double *p)
{
    const constraint_nodes *at = &work->nodes;
    const tvi_status status = tvi_constraint_set_W(&work->one, t, q, p);
    if (status == TVI_OK) memcpy(at->W, work->one.W, (size_t)(at->has_masses ? at->n : at->n * at->n) * sizeof *at->W);
    return status;
}

/* Sets the scales of the constraints for a step of size h. Where masses are constant, h W is the number that moves
 * positions by p, too: with another roundoff the step would not be symplectic. */
tvi_status tvi_constrained_set_scales(constrained_work *work, double h, const tvi_step_origin *origin)
{
    constraint_nodes *at = &work->nodes;
    const tvi_status status = set_W(work, origin->t, origin->q, origin->p);
    at->h = h;
    if (work->galerkin->step.is_separable)
        memcpy(at->hW, work->galerkin->step.nodes.scale, (size_t)at->n * sizeof *at->hW);
    else
        for (int i = 0; i < (at->has_masses ? at->n : at->n * at->n); i++) at->hW[i] = h * at->W[i];
    return status;
}

/* Sets the motion of the positions at the targets without impulses. In equations of first order it is q alone. */
static void set_free_positions(constrained_work *work, const tvi_step_origin *origin)
{
    const constraint_nodes *at = &work->nodes;
    const galerkin_step *step = &work->galerkin->step;
    galerkin_nodes targets = step->nodes;
    targets.unknown_count = at->n;
    targets.free_motion = at->X.free;
    targets.free_motion_low = at->X.free_low;
    if (step->is_separable) {
        nodes_set_linear_free_motion(&targets, work->tables.d, origin, step->move, step->move_low);
        return;
    }
    for (int i = 0; i < at->n; i++)
        for (int lane = 0; lane < targets.lane_count; lane++) {
            at->X.free[i * targets.lane_count + lane] = origin->q[i];
            at->X.free_low[i * targets.lane_count + lane] = origin->q_low[i];
        }
}

/* Adds what the impulses of the constraints do to the unknowns at the Gauss nodes to the free motion. */
void tvi_constrained_add_impulses(const constrained_work *work)
{
    const constraint_nodes *at = &work->nodes;
    const galerkin_step *step = &work->galerkin->step;
    const int lanes = step->nodes.lane_count, first = step->is_separable ? 0 : at->n;
    BY_LANES(width, lanes, constraint_sum(at->n, work->tables.source_to_gauss, at->K, work->sum, width));
    for (int i = 0; i < at->n; i++)
        for (int k = i * lanes; k < (i + 1) * lanes; k++)
            step->nodes.free_motion_low[first * lanes + k] =
                work->low_without_impulses[first * lanes + k] + (step->is_separable ? at->hW[i] : 1) * work->sum[k];
}

/* Sets by_forces: what the impulses of the forces do to the positions at the targets. In equations of first order they
 * have acted on the positions by velocities that know the present K, whose part is taken off to first order. */
void tvi_constrained_set_by_forces(const constrained_work *work)
{
    const constraint_nodes *at = &work->nodes;
    const galerkin_step *step = &work->galerkin->step;
    const int lanes = step->nodes.lane_count;
    double *to = at->X.by_forces;
    BY_LANES(width, lanes, constraint_sum(at->n, work->tables.gauss_to_target, step->nodes.impulse, to, width));
    if (step->is_separable) {
        for (int i = 0; i < at->n; i++)
            for (int k = i * lanes; k < (i + 1) * lanes; k++) to[k] *= at->hW[i];
        return;
    }
    BY_LANES(width, lanes, constraint_sum(at->n, work->tables.source_to_target, at->K, at->pass.scratch, width);
             constraint_apply_W(at, at->hW, at->pass.scratch, work->sum, width));
    for (int k = 0; k < at->n * lanes; k++) to[k] -= work->sum[k];
}

/* Predicts the multipliers from those of the last steps of this size, or, where there is none, from those at the start
 * of the step, of which lambda [count] is set. */
static void predict_multipliers(constrained_work *work, int equal_step_count, int ring_index)
{
    const constraint_nodes *at = &work->nodes;
    const int m = work->tables.node_count, lanes = work->galerkin->step.nodes.lane_count;
    memset(at->mu, 0, (size_t)(at->count * lanes) * sizeof *at->mu);
    for (int k = 0; k < at->count; k++)
        for (int j = 0; j < m; j++) {
            double lambda = equal_step_count > 0 ? 0 : work->lambda[k];
            for (int past = 0; past < equal_step_count; past++) {
                const double *of = work->ring[(ring_index - past + GALERKIN_RING_LENGTH) % GALERKIN_RING_LENGTH].lambda;
                const double *table = equal_step_count > 1 ? work->tables.two_steps : work->tables.last_step;
                for (int i = 0; i <= m; i++) lambda += table[(past * (m + 1) + i) * (m + 1) + j] * of[k * (m + 1) + i];
            }
            at->mu[k * lanes + j] = at->h * work->tables.w[j] * lambda;
        }
}

/* Predicts the impulses of the forces from those of the last steps of this size. */
static void predict_impulses(constrained_work *work, int equal_step_count, int ring_index)
{
    const galerkin_step *step = &work->galerkin->step;
    const int lanes = step->nodes.lane_count, unknowns = step->nodes.unknown_count;
    const double *table = work->fit[equal_step_count > 1 ? 0 : 1];
    BY_LANES(width, lanes,
             constraint_sum(unknowns, table, galerkin_ring_at(step, ring_index), step->nodes.impulse, width));
    if (equal_step_count < 2) return;
    BY_LANES(
        width, lanes, for (int u = 0; u < unknowns; u++) {
            constraint_sum(1, table + lanes * lanes, galerkin_ring_at(step, ring_index - 1) + u * lanes, work->sum,
                           width);
            for (int lane = 0; lane < width; lane++) step->nodes.impulse[u * lanes + lane] += work->sum[lane];
        });
}

tvi_status tvi_constrained_predict(constrained_work *work, const tvi_step_origin *origin, int equal_step_count,
                                   tvi_stats *stats)
{
    constraint_nodes *at = &work->nodes;
    galerkin_work *galerkin = work->galerkin;
    galerkin_step *step = &galerkin->step;
    const int lanes = step->nodes.lane_count, entries = at->constraints->entry_count;
    const size_t unknown_bytes = (size_t)(step->nodes.unknown_count * lanes) * sizeof(double);
    tvi_status status = set_factor_of_state(work, origin->t, origin->q, origin->q_low, at->G.start, at->S.start);
    if (status != TVI_OK) return status;
    step->nodes.impulse = galerkin_ring_at(step, (int)galerkin->predictor.history->ring_index + 1);
    galerkin_set_free_motion(step, origin);
    memcpy(work->low_without_impulses, step->nodes.free_motion_low, unknown_bytes);
    set_free_positions(work, origin);
    if (equal_step_count == 0)
        status = tvi_constraint_multipliers(&work->one, origin->t, origin->q, origin->p, work->lambda);
    if (status != TVI_OK) return status;
    predict_multipliers(work, equal_step_count, (int)galerkin->predictor.history->ring_index);
    for (int e = 0; e < entries; e++)
        for (int lane = 0; lane < lanes; lane++) at->G.sources[e * lanes + lane] = at->G.start[e];
    BY_LANES(width, lanes, constraint_set_impulses(at, NULL, width));
    tvi_constrained_add_impulses(work);
    if (equal_step_count == 0) {
        tvi_galerkin_set_node_times(galerkin, origin, 0);
        stats->force_evaluations++;
        status = tvi_galerkin_predict_from_start(galerkin, origin);
        if (status != TVI_OK) return status;
    } else if (step->form == GALERKIN_LAGRANGIAN) {
        const galerkin_outcome so_far = {.ring_index = (int)galerkin->predictor.history->ring_index,
                                         .equal_step_count = equal_step_count};
        galerkin_predict_from_ring(step, &so_far);
    } else {
        predict_impulses(work, equal_step_count, (int)galerkin->predictor.history->ring_index);
        (void)constrained_move_unknowns(step);
    }
    tvi_constrained_set_by_forces(work);
    BY_LANES(width, lanes, constraint_set_moved(at, at->X.moved, width));
    memset(at->X.end_roundoff, 0, (size_t)at->n * sizeof *at->X.end_roundoff);
    for (int k = 0; k < at->n * lanes; k++) at->X.now[k] = at->X.free[k] + (at->X.moved[k] + at->X.free_low[k]);
    return TVI_OK;
}

/* ---- The end of a step ------------------------------------------------------------------------------------------- */

/* Adds the impulses of the sources to the sums of those of the forces, and the last terms of both. */
static void add_impulses_to_sums(const constrained_work *work, const galerkin_sums *sums)
{
    const constraint_nodes *at = &work->nodes;
    const galerkin_step *step = &work->galerkin->step;
    const int m = work->tables.node_count, lanes = step->nodes.lane_count, first = step->is_separable ? 0 : at->n;
    for (int i = 0; i < at->n; i++) {
        const double *K = at->K + i * lanes, sign = step->is_separable ? 1 : step->nodes.scale[at->n + i];
        for (int j = 0; j < m; j++) {
            constrained_add_product(sign, K[j], &sums->once[first + i], &sums->once_low[first + i]);
            constrained_add_product(work->tables.one_minus_d[j], K[j], &sums->twice[first + i],
                                    &sums->twice_low[first + i]);
        }
    }
}

/* Computes the tail, in which the last term of the forces of constraint counts as that of the forces does. */
static double compute_tail(const constrained_work *work, const tvi_step_origin *origin, const double *dp,
                           const constraint_record *record)
{
    const constraint_nodes *at = &work->nodes;
    const galerkin_step *step = &work->galerkin->step;
    const int m = work->tables.node_count, first = step->is_separable ? 0 : at->n;
    galerkin_tail tail = step->tail;
    tail.q = origin->q;
    tail.p = origin->p;
    tail.dp = dp;
    for (int i = 0; i < at->n; i++) {
        double last = 0, size = 0;
        for (int j = 0; j <= m; j++) {
            last += work->tables.last_term[j] * record->K[i * (m + 1) + j];
            size += fabs(record->K[i * (m + 1) + j]);
        }
        tail.sums.last_term[first + i] = tvi_larger(tail.sums.last_term[first + i], fabs(last));
        tail.sums.ends[first + i] += size / tail.inverse_end_weight;
    }
    return m > 1 ? galerkin_compute_tail(&tail) : 0;
}

/* Finds the impulse of the last node, which takes the velocity onto the constraints: G v + phi_t = 0 at the end q of
 * the step, with p before. It acts on the momenta alone. With masses the first round finds it; the others end where the
 * rates no longer shrink. */
static tvi_status find_last_impulse(constrained_work *work, double t, const double *q, const double *p)
{
    const constraint_nodes *at = &work->nodes;
    const int n = at->n;
    double before = INFINITY, *moved = work->v, *rate = at->pass.residual, *mu = work->lambda;
    memset(work->K, 0, (size_t)n * sizeof *work->K);
    memset(mu, 0, (size_t)at->count * sizeof *mu);
    for (int round = 0; round < CONSTRAINT_MAX_ROUNDS; round++) {
        for (int i = 0; i < n; i++) moved[i] = p[i] + work->K[i];
        const tvi_status status = tvi_constraint_evaluate(&work->one, t, q, moved, at->pass.phi, rate);
        if (status != TVI_OK) return status;
        constraint_solve(at, work->S, rate, 1);
        double size = 0;
        for (int k = 0; k < at->count; k++) size = tvi_larger(size, fabs(rate[k]));
        if (round > 1 && !(size < before)) break;
        before = size;
        for (int k = 0; k < at->count; k++) mu[k] += rate[k];
        constraint_apply_GT(at, work->G, mu, work->K, 1);
        for (int i = 0; i < n; i++) work->K[i] = -work->K[i];
    }
    return TVI_OK;
}

tvi_status tvi_constrained_set_increments(constrained_work *work, const tvi_step_origin *origin,
                                          const tvi_increments *to, const constraint_record *record, double *tail)
{
    const constraint_nodes *at = &work->nodes;
    const galerkin_step *step = &work->galerkin->step;
    const galerkin_sums *sums = &step->tail.sums;
    const int n = at->n, m = work->tables.node_count, lanes = step->nodes.lane_count;
    nodes_sum_impulses(&step->nodes, &step->sum_weights, sums);
    add_impulses_to_sums(work, sums);
    if (step->is_separable) nodes_set_separable_increments(&step->nodes, sums, step->move, step->move_low, to);
    else nodes_set_increments(&step->nodes, sums, to);
    memcpy(work->q, origin->q, (size_t)n * sizeof *work->q);
    memcpy(work->q_low, origin->q_low, (size_t)n * sizeof *work->q);
    memcpy(work->p, origin->p, (size_t)n * sizeof *work->p);
    memcpy(work->p_low, origin->p_low, (size_t)n * sizeof *work->p);
    (void)tvi_add_all_compensated(n, work->q, work->q_low, to->dq, to->dq_low);
    (void)tvi_add_all_compensated(n, work->p, work->p_low, to->dp, to->dp_low);
    const double t_end = origin->t + (origin->t_low + at->h);
    tvi_status status = at->has_masses ? TVI_OK : set_W(work, t_end, work->q, work->p);
    if (status == TVI_OK) status = set_factor_of_state(work, t_end, work->q, work->q_low, work->G, work->S);
    if (status == TVI_OK) status = find_last_impulse(work, t_end, work->q, work->p);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) {
        memcpy(record->K + i * (m + 1), at->K + i * lanes, (size_t)m * sizeof *at->K);
        record->K[i * (m + 1) + m] = work->K[i];
        constrained_add_product(1, work->K[i], &to->dp[i], &to->dp_low[i]);
    }
    for (int k = 0; k < at->count; k++)
        for (int j = 0; j <= m; j++)
            record->lambda[k * (m + 1) + j] =
                (j < m ? at->mu[k * lanes + j] : work->lambda[k]) / (at->h * work->tables.w[j]);
    *tail = compute_tail(work, origin, to->dp, record);
    return TVI_OK;
}

/* ---- The curve of the last step ---------------------------------------------------------------------------------- */

/* Adds to x [n][points] what the impulses of the constraints do: scale_i sum_j integral[j][.] K_j. */
static void add_constraint_curve(const constrained_work *work, tvi_component_range range, int points,
                                 const double *integral, const double *scale, double *x)
{
    const int m = work->tables.node_count;
    const double *K = work->ring[work->galerkin->predictor.history->ring_index].K;
    for (int i = range.first; i < range.end; i++)
        for (int j = 0; j <= m; j++)
            for (int point = 0; point < points; point++)
                x[i * points + point] += (scale ? scale[i] : 1) * (integral[j * points + point] * K[i * (m + 1) + j]);
}

void tvi_constrained_interpolate(void *self, double theta, double dq[], double dp[])
{
    const constrained_work *work = self;
    const tvi_component_range all = {0, work->nodes.n};
    double single[LOBATTO_MAX], twice[LOBATTO_MAX];
    tvi_lobatto_integrate(&work->tables, theta, single, twice);
    tvi_galerkin_interpolate(work->galerkin, theta, dq, dp);
    if (work->galerkin->step.is_separable) add_constraint_curve(work, all, 1, twice, work->nodes.hW, dq);
    add_constraint_curve(work, all, 1, single, NULL, dp);
}

void tvi_constrained_sample(void *self, const tvi_component_range used[2], const double q_start[],
                            const double p_start[], double *q, double *p)
{
    const constrained_work *work = self;
    tvi_galerkin_sample(work->galerkin, used, q_start, p_start, q, p);
    if (work->galerkin->step.is_separable)
        add_constraint_curve(work, used[0], TVI_SAMPLES, work->tables.double_samples, work->nodes.hW, q);
    add_constraint_curve(work, used[1], TVI_SAMPLES, work->tables.single_samples, NULL, p);
}
