/* curve_batch.c - makes corrected steps of several members of an ensemble at once, as curve_stepper.c does for one:
 * lane m of a sweep is member m. It serves generating functions whose equations are those of the mean of the ends, I +
 * O(h), which are factored without exchanges of rows.
 *
 * All that a pass computes follows from z, including the Jacobians, which single curves mostly compute anew as well. A
 * member that has converged therefore stays as it is while the others continue. A member that does not converge in this
 * way, or is outside of the domain, makes its step by itself. */
#include "generating/curve_pass.h"
#include "generating/curve.h"
#include "algebra/quadrature.h"
#include "algebra/sizes.h"
#include "method/method.h"

#include <math.h>
#include <string.h>

enum { MOST_WIDTH = 32, LEAST_WIDTH = 8, MOST_N = 7 };
/* These bound the blocks of the series and of its tangents along one direction, which are to stay in the first-level
 * cache; a block of the least width may be larger. */
enum { MOST_BYTES = 32 << 10, MOST_BYTES_OF_ALL = 256 << 10 };
/* Smaller pivots are left to steps that exchange rows. Pivots do not depend on units where equations are I + O(h). */
static const double LEAST_PIVOT = 0.25;

typedef tvi_curve_batch_work batch;

/* ---- Memory and tables ------------------------------------------------------------------------------------------- */

static const tvi_taylor_loops *const series_of[JET_ISA_COUNT] = {
    [jet_isa_base] = &tvi_taylor_loops_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = &tvi_taylor_loops_avx2,
    [jet_isa_avx512] = &tvi_taylor_loops_avx512,
#endif
};
static const tvi_curve_loops *const loops_of[JET_ISA_COUNT] = {
    [jet_isa_base] = &tvi_curve_loops_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = &tvi_curve_loops_avx2,
    [jet_isa_avx512] = &tvi_curve_loops_avx512,
#endif
};

static int top_of(const tvi_system *system, const tvi_options *options)
{
    return options->degree + (tvi_method_of(options)->curve.has_top_momentum && system->form == TVI_SEPARABLE);
}

/* Returns whether the field of the curves needs no momenta of nodes, and the action no summation by parts. */
static bool serves(const tvi_system *system, const tvi_options *options)
{
    const tvi_expanded *expanded = &tvi_method_of(options)->curve;
    const bool has_field =
        system->form == TVI_SEPARABLE || (system->form == TVI_HAMILTONIAN && expanded->action == TVI_ACTION_HAMILTON);
    const int degrees = 2 * options->degree - !expanded->has_top_momentum;
    return expanded->close == tvi_close_mean && has_field && options->passes != TVI_PREDICT_ONLY &&
           options->nodes == TVI_NODES_ON_CURVE && system->n <= MOST_N &&
           tvi_curve_jacobians_for(system) == TVI_JACOBIAN_MATRICES && top_of(system, options) > 1 &&
           tvi_quadrature_order(options->quadrature, options->quadrature_points) >= degrees;
}

static int width_of(const tvi_system *system, const tvi_options *options)
{
    if (!serves(system, options)) return 1;
    const int bytes = 2 * system->field_series->slots * (top_of(system, options) + 1) * (int)sizeof(double);
    int width = LEAST_WIDTH;
    if (LEAST_WIDTH * bytes > MOST_BYTES_OF_ALL) return 1;
    while (2 * width <= MOST_WIDTH && 2 * width * bytes <= MOST_BYTES) width *= 2;
    return width;
}

static void take_members(tvi_curve_members *members, tvi_arena *arena, const tvi_system *system, int width)
{
    const int n = system->n;
    const size_t row = (size_t)width, rows = 2 * (size_t)n;
    double **const vectors[] = {&members->z,    &members->scale, &members->D,
                                &members->from, &members->rise,  &members->correction};
    for (size_t i = 0; i < 6; i++) *vectors[i] = tvi_arena_doubles(arena, rows * row);
    double **const numbers[] = {&members->least, &members->relative, &members->of_group};
    for (size_t i = 0; i < 3; i++) *numbers[i] = tvi_arena_doubles(arena, row);
    members->kappa = tvi_arena_doubles(arena, (size_t)n);
    members->n = n;
    members->parts = &system->parts;
    members->width = width;
}

static tvi_taylor_lanes lanes_of(const tvi_system *system, int top, int width, const double *kappa, double *x)
{
    return (tvi_taylor_lanes){.n = system->n,
                              .width = width,
                              .top = top,
                              .stride = (size_t)system->field_series->slots * (size_t)width,
                              .kappa = kappa,
                              .output = system->field_series->output,
                              .x = x,
                              .has_masses = system->form == TVI_SEPARABLE,
                              .system = system};
}

static tvi_weights take_weights(tvi_arena *arena, int outs, int rows)
{
    return (tvi_weights){tvi_arena_doubles(arena, (size_t)outs * (size_t)rows), outs, rows, (size_t)rows, 1};
}

static void take_nodes(batch *w, tvi_arena *arena, const tvi_options *options, int orders, int width)
{
    const int points = options->quadrature_points;
    const bool is_separable = w->system->form == TVI_SEPARABLE;
    const bool has_momenta = tvi_method_of(options)->curve.action == TVI_ACTION_HAMILTON;
    w->x = tvi_arena_block(arena, w->system->field_values, 1, points * width, 0);
    w->defect = tvi_arena_doubles(arena, 2 * (size_t)points * (size_t)width);
    for (int i = 0; i < TVI_SUMS; i++) {
        w->at_nodes[i] = tvi_arena_doubles(arena, (size_t)points * (size_t)width);
        w->node_sums[i].weights = take_weights(arena, points, orders);
    }
    w->seeds_q = take_weights(arena, orders, is_separable && has_momenta ? 2 * points : points);
    w->seeds_p = take_weights(arena, orders, points);
    w->q_sizes = tvi_arena_doubles(arena, (size_t)orders);
    w->z_sizes = tvi_arena_doubles(arena, (size_t)orders);
}

static void *take(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width)
{
    batch *taken = tvi_arena_take(arena, sizeof *taken);
    const jet_isa isa = system->field_series->sweeps->isa;
    const int n = system->n, top = top_of(system, options);
    const size_t count = (size_t)width, rows = 2 * (size_t)n * count, orders = (size_t)top + 1;
    const size_t coefficients = orders * (size_t)system->inputs * count;
    batch w = {.system = system, .series = series_of[isa], .loops = loops_of[isa]};
    tvi_single_take(&w.by_itself, arena, &tvi_stepper_curve, system, options, width, options->quadrature_points);
    w.single = w.by_itself.work;
    const tvi_expanded *expanded = &tvi_method_of(options)->curve;
    const int p_degree = expanded->has_top_momentum ? options->degree : options->degree - 1;
    tvi_action_take(&w.action, arena, system, options, expanded->action, options->degree, p_degree, top, false);
    w.closing = &expanded->mean;
    take_members(&w.members, arena, system, width);
    take_nodes(&w, arena, options, top + 1, width);
    double *const x = tvi_arena_block(arena, system->field_series, top + 1, width, 0);
    double *const dx = tvi_arena_doubles(arena, orders * (size_t)system->field_series->slots * count);
    w.curve = lanes_of(system, top, width, w.members.kappa, x);
    w.tangent = lanes_of(system, top, width, w.members.kappa, dx);
    w.J = tvi_arena_doubles(arena, 2 * (size_t)n * coefficients);
    w.seed = tvi_arena_doubles(arena, coefficients);
    w.full = tvi_arena_doubles(arena, 2 * (size_t)n * rows);
    w.back = tvi_arena_doubles(arena, 2 * (size_t)n * rows);
    w.values = tvi_arena_doubles(arena, rows);
    w.change = tvi_arena_doubles(arena, rows);
    double **const of_n[] = {&w.dq, &w.dp, &w.share, &w.ratio, &w.sizes.size, &w.sizes.bend};
    for (size_t i = 0; i < 6; i++) *of_n[i] = tvi_arena_doubles(arena, (size_t)n * count);
    w.tail = tvi_arena_doubles(arena, count);
    w.is_moving = tvi_arena_take(arena, count * sizeof *w.is_moving);
    w.progress = tvi_arena_take(arena, count * sizeof *w.progress);
    w.history = tvi_arena_history(arena, count * sizeof *w.history);
    w.passes = tvi_arena_take(arena, count * sizeof *w.passes);
    if (taken) *taken = w;
    return taken;
}

/* Sets the weights of the sums at the nodes, which curve_stepper.c and action.c also have, in one table:
 * [points][orders]. */
static void set_node_sums(batch *w, int which, bool of_momentum, const double *power, int degree)
{
    const tvi_curve *curve = &w->single->closure.curve;
    const tvi_action *action = &w->action;
    tvi_weights *weights = &w->node_sums[which].weights;
    for (int node = 0; node < action->points; node++) {
        double weight[TVI_MAX_DEGREE + 2] = {0};
        tvi_combination one = {.weight = weights->weight + (size_t)node * weights->per_out};
        for (int k = 0; k <= degree; k++) weight[k] = power[k * action->points + node];
        tvi_combination_set(&one, curve, of_momentum, weight);
        w->node_sums[which].of_momentum = one.of_momentum;
    }
}

/* Sets the weights of the seeds. For a separable system dp_i is a sum of dQ, since U_k = (k+1) Q_{k+1}. */
static void set_seeds(batch *w)
{
    const tvi_action *action = &w->action;
    const int points = action->points;
    double *const of_q = w->seeds_q.weight, *const of_p = w->seeds_p.weight;
    for (int node = 0; node < points; node++)
        for (int k = 0; k < action->orders; k++) {
            const double weight = action->weighted_power.full[node * action->orders + k];
            of_q[k * w->seeds_q.rows + node] = k <= action->q_degree ? weight : 0;
            of_p[k * w->seeds_p.rows + node] = k <= action->p_degree ? weight : 0;
            if (w->seeds_q.rows > points && k <= action->p_degree && k + 1 < action->orders)
                of_q[(k + 1) * w->seeds_q.rows + points + node] = (k + 1) * weight;
        }
}

static void prepare(void *work)
{
    batch *w = work;
    tvi_single_prepare(&w->by_itself);
    const tvi_curve_work *single = w->single;
    const tvi_action *action = &w->action;
    tvi_action_prepare(&w->action, single->options, single->closure.span, w->curve.top);
    set_node_sums(w, TVI_SUM_Q, false, action->power.full, action->q_degree);
    set_node_sums(w, TVI_SUM_U, true, action->power.full, action->p_degree);
    set_node_sums(w, TVI_SUM_Q_SLOPE, false, action->slope.full, action->q_degree);
    set_node_sums(w, TVI_SUM_U_SLOPE, true, action->slope.full, action->p_degree);
    set_seeds(w);
    for (int k = 0; k < action->orders; k++) {
        w->q_sizes[k] = 1;
        w->z_sizes[k] = k > 0 || w->system->form == TVI_HAMILTONIAN;
    }
    w->rules = tvi_newton_rules_asked(single->options, true, single->is_rough);
}

/* ---- A step ------------------------------------------------------------------------------------------------------ */

/* Begins a step, with z the data of the curve from the start of the step. Returns how many members are in lanes. */
static int begin(batch *w, double h, const tvi_batch_origin *origin, const tvi_status status[])
{
    const tvi_curve_members *members = &w->members;
    const int half = members->n * members->width;
    int count = 0;
    w->curve.tau = w->tangent.tau = w->single->closure.span.tau * h;
    memcpy(members->z, origin->q, (size_t)half * sizeof *members->z);
    for (int i = 0; i < members->n; i++) {
        members->kappa[i] = w->curve.has_masses ? w->curve.tau / w->system->mass[i] : 1;
        for (int at = i * members->width; at < (i + 1) * members->width; at++)
            members->z[half + at] = members->kappa[i] * origin->p[at];
    }
    for (int m = 0; m < members->width; m++) {
        const bool moves = status[m] == TVI_OK;
        w->progress[m] = moves ? TVI_MOVING : TVI_LEFT_ALONE;
        w->is_moving[m] = moves ? -1 : 0;
        if (moves) tvi_newton_begin(&w->passes[m], &w->history[m], &w->rules, w->single->is_rough);
        count += moves;
    }
    return count;
}

/* Judges the corrections. Members that have converged stop moving; the others make the correction. Returns how many
 * move. */
static int judge(batch *w)
{
    const tvi_curve_members *members = &w->members;
    int count = 0;
    for (int m = 0; m < members->width; m++) {
        if (!w->is_moving[m]) continue;
        const tvi_newton_size size = {members->relative[m], members->of_group[m]};
        const bool is_solved = isfinite(size.relative) && members->least[m] >= LEAST_PIVOT;
        const tvi_passes_verdict verdict =
            is_solved ? tvi_newton_judge(&w->passes[m], &w->rules, size) : TVI_PASSES_STUCK;
        if (verdict == TVI_PASSES_STUCK) tvi_curve_leave(w, m);
        if (verdict != TVI_PASSES_MAY_END) continue;
        w->progress[m] = TVI_DONE;
        w->is_moving[m] = 0;
        tvi_newton_learn(&w->history[m], &w->passes[m]);
    }
    for (int m = 0; m < members->width; m++) count += w->is_moving[m] != 0;
    return count;
}

static void iterate(batch *w, const tvi_batch_origin *origin, int count, tvi_stats *stats)
{
    stats->expansions += count;
    for (int passes = 1; count > 0 && passes <= w->rules.of_each.most; passes++) {
        tvi_curve_pass(w, origin, passes == 1);
        stats->passes += count;
        stats->expansions += count;
        stats->factorisations += 2 * count;
        stats->force_evaluations += count * w->action.points;
        count = judge(w);
        if (count > 0) w->loops->move(&w->members, w->is_moving);
    }
    for (int m = 0; m < w->members.width && count > 0; m++)
        if (w->is_moving[m]) tvi_curve_leave(w, m);
}

/* Writes the increments of the members that have converged. */
static void finish(batch *w, const tvi_batch_end *end, tvi_stats *stats)
{
    const tvi_curve_members *members = &w->members;
    const int half = members->n * members->width;
    tvi_curve_finish_members(w);
    for (int m = 0; m < members->width; m++) {
        if (w->progress[m] != TVI_DONE) continue;
        for (int at = m; at < half; at += members->width) {
            end->increments.dq[at] = w->dq[at];
            end->increments.dp[at] = w->dp[at];
        }
        end->tail[m] = stats->tail = w->tail[m];
        end->passes[m] = w->passes[m].of_each.count;
        stats->residual = members->relative[m];
    }
}

static void get(const void *work, int lane, void *one)
{
    *((tvi_curve_work *)one)->newton.history = ((const batch *)work)->history[lane];
}

static void put(void *work, int lane, const void *one)
{
    ((batch *)work)->history[lane] = *((const tvi_curve_work *)one)->newton.history;
}

static void forget(void *work, int lane) { memset(&((batch *)work)->history[lane], 0, sizeof(tvi_newton_history)); }

static void step_by_itself(batch *w, double h, const tvi_batch_origin *origin, const tvi_batch_end *end, int m,
                           tvi_stats *stats)
{
    get(w, m, w->single);
    if (tvi_single_step(&w->by_itself, w->system->field_series, w->curve.x, 1, h, origin, end, m, stats))
        put(w, m, w->single);
}

static void step(void *work, double h, const tvi_batch_origin *origin, const tvi_batch_end *end, tvi_stats *stats)
{
    batch *w = work;
    const int count = begin(w, h, origin, end->status);
    tvi_curve_predict_members(w, origin);
    iterate(w, origin, count, stats);
    finish(w, end, stats);
    for (int m = 0; m < w->members.width; m++)
        if (w->progress[m] == TVI_BY_ITSELF) step_by_itself(w, h, origin, end, m, stats);
}

const tvi_batch_stepper tvi_curve_batch = {.width = width_of,
                                           .take = take,
                                           .prepare = prepare,
                                           .step = step,
                                           .lane_to_scalar = get,
                                           .scalar_to_lane = put,
                                           .forget = forget};
