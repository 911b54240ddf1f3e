/* action.c - allocates a discrete action, and computes its tables: the powers of the quadrature's nodes and their
 * derivatives, which depend only on the quadrature and on the ends of the step in scaled time (docs/method.md section
 * 4). */
#include "generating/action.h"
#include "algebra/quadrature.h"
#include "algebra/sizes.h"
#include "method/method.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- Sizes and memory -------------------------------------------------------------------------------------------- */

/* Returns the number of nodes in each of the two halves of a step whose nodes mirror each other. The number is padded
 * to whole vectors if the field's tape processes as many vectors with the padding as without; otherwise it is not
 * padded. */
static int choose_mirrored_half_size(const tvi_system *system, int points)
{
    const int lanes = 2 << system->field_values->sweeps->isa, half = (points + 1) / 2, whole = TVI_WHOLE_VECTORS(half);
    return (2 * whole + lanes - 1) / lanes > (2 * half + lanes - 1) / lanes ? half : whole;
}

tvi_action tvi_action_shape(const tvi_system *system, const tvi_options *options)
{
    const tvi_curve_definition *definition = &tvi_find_method(options)->curve;
    const tvi_step_span span = definition->step_span;
    const int degree = options->degree, p_degree = definition->uses_highest_momentum_term ? degree : degree - 1;
    const bool is_hamilton = definition->action == TVI_ACTION_HAMILTON, separable = system->form == TVI_SEPARABLE;
    const bool one_more = definition->uses_highest_momentum_term && separable; /* p of degree N needs Q_{N+1} */
    tvi_action shape = {.is_hamilton = is_hamilton,
                        .is_truncated = options->nodes == TVI_NODES_TRUNCATED,
                        .has_by_v = !is_hamilton && !separable,
                        .has_by_p = is_hamilton && (!separable || p_degree >= degree),
                        .q_degree = degree,
                        .p_degree = p_degree,
                        .nodes = options->quadrature_points,
                        .order_count = degree + one_more + 1};
    if (span.start_s == -span.end_s && !(is_hamilton && shape.is_truncated) &&
        tvi_quadrature_mirror(options->quadrature) == options->quadrature) {
        shape.half = choose_mirrored_half_size(system, options->quadrature_points);
        shape.nodes = 2 * shape.half;
    }
    return shape;
}

void tvi_action_allocate(tvi_action *action, tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    *action = tvi_action_shape(system, options);
    const size_t orders = (size_t)action->order_count, nodes = (size_t)action->nodes, n = (size_t)system->n,
                 half_rows =
                     (size_t)(TVI_WHOLE_VECTORS((action->order_count + 1) / 2) * TVI_WHOLE_VECTORS(action->half));
    const bool needs_momenta = system->form == TVI_HAMILTONIAN && !action->is_hamilton;
    action->tape = needs_momenta ? system->field_series : system->field_values;
    tvi_arena_allocate_each(arena, nodes, (double **[]){&action->tables.s, &action->tables.weight, NULL});
    tvi_node_table *const tables[] = {&action->tables.power,          &action->tables.slope,
                                      &action->tables.second,         &action->tables.node_power,
                                      &action->tables.weighted_power, &action->tables.weighted_slope};
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
        tables[i]->all = tvi_arena_allocate_doubles(arena, orders * nodes);
        tvi_arena_allocate_each(arena, half_rows, (double **[]){&tables[i]->even, &tables[i]->odd, NULL});
    }
    action->node_sums = tvi_arena_allocate_doubles(arena, orders);
    if (tvi_quadrature_order(options->quadrature, options->quadrature_points) < action->q_degree + action->p_degree)
        action->tables.by_parts = tvi_arena_allocate_doubles(arena, orders * orders);
    action->slots = tvi_arena_allocate_block(arena, action->tape, 1, action->nodes, 0);
    if (system->form == TVI_HAMILTONIAN && action->is_hamilton && action->is_truncated)
        action->Hp_slots = tvi_arena_allocate_block(arena, system->r_dot_Hp_values, 1, action->nodes, 0);
    action->P = tvi_arena_allocate_doubles(arena, orders * n);
    tvi_arena_allocate_each(arena, n * nodes,
                            (double **[]){&action->at_nodes.p, &action->at_nodes.dp_ds, &action->at_nodes.by_q,
                                          &action->at_nodes.by_v, &action->at_nodes.by_p, &action->momenta.dp, NULL});
    if (needs_momenta) {
        action->momenta.H_pp = tvi_arena_allocate_doubles(arena, n * n * nodes);
        action->momenta.tangents = tvi_arena_allocate_doubles(arena, (size_t)action->tape->slot_count * nodes);
    }
    tvi_roundoff_allocate(&action->roundoff, arena, system);
}

/* ---- The tables -------------------------------------------------------------------------------------------------- */

/* Returns e_r, the quadrature of s^r over the span less its integral; it is exactly 0 below the order of the
 * quadrature. */
static double quadrature_error(int order, int points, const long double s[], const long double weight[], int r,
                               tvi_step_span span)
{
    if (r < order) return 0;
    long double error = -(powl(span.end_s, r + 1) - powl(span.start_s, r + 1)) / (r + 1);
    for (int i = 0; i < points; i++) error += weight[i] * powl(s[i], r);
    return (double)error;
}

/* Sets the columns of a node at s in all tables; the weighted ones are transposed. */
static void set_node(tvi_action *action, int node, long double s, bool is_end_of_step)
{
    for (int k = 2; k < action->order_count; k++)
        action->tables.second.all[k * action->nodes + node] = (double)(k * (k - 1) * powl(s, k - 2));
    for (int k = 0; k <= action->q_degree; k++) {
        const int at = k * action->nodes + node, weighted = node * action->order_count + k;
        const bool is_left_out = action->is_truncated && k == action->q_degree && !is_end_of_step;
        const double power = (double)powl(s, k), slope = k == 0 ? 0 : k * (double)powl(s, k - 1);
        action->tables.power.all[at] = power;
        action->tables.slope.all[at] = slope;
        action->tables.node_power.all[at] = is_left_out ? 0 : power;
        action->tables.weighted_power.all[weighted] = action->tables.weight[node] * power;
        action->tables.weighted_slope.all[weighted] = action->tables.weight[node] * slope;
    }
}

/* Copies the even and the odd orders at the first half of the nodes. */
static void split_table(const tvi_action *action, tvi_node_table *table, bool is_weighted, double mirror_sign)
{
    const int half = action->half, orders = action->order_count, width = TVI_WHOLE_VECTORS((orders + 1) / 2);
    table->mirror_sign = mirror_sign;
    for (int k = 0; k < orders; k++)
        for (int node = 0; node < half; node++) {
            double *rows = k % 2 == 0 ? table->even : table->odd;
            if (is_weighted) rows[node * width + k / 2] = table->all[node * orders + k];
            else rows[k / 2 * half + node] = table->all[k * action->nodes + node];
        }
}

/* Returns the node of the quadrature rule at which this node of the action lies, and sets *share to the share of the
 * rule's weight that the node of the action has. */
static int quadrature_node(const tvi_action *action, int points, int node, double *share)
{
    const int half = action->half, in_half = half > 0 ? node % half : node,
              i = in_half < (points + 1) / 2 || half == 0 ? in_half : 0;
    *share = i != in_half ? 0 : half > 0 && 2 * in_half + 1 == points ? 0.5 : 1;
    return half > 0 && node >= half ? points - 1 - i : i;
}

void tvi_action_set_tables(tvi_action *action, const tvi_options *options, tvi_step_span span)
{
    const int points = options->quadrature_points, order = tvi_quadrature_order(options->quadrature, points);
    const double length = span.end_s - span.start_s;
    long double s[TVI_MAX_POINTS], weight[TVI_MAX_POINTS];
    bool is_end[TVI_MAX_POINTS];
    tvi_quadrature_compute_nodes(options->quadrature, points, s, weight);
    for (int i = 0; i < points; i++) { /* from [-1, 1] to the span */
        is_end[i] = s[i] == -1 || s[i] == 1;
        s[i] = span.start_s + length * (1 + s[i]) / 2;
        weight[i] *= length / 2;
    }
    for (int node = 0; node < action->nodes; node++) {
        double share;
        const int i = quadrature_node(action, points, node, &share);
        action->tables.s[node] = (double)s[i];
        action->tables.weight[node] = share * (double)weight[i];
        set_node(action, node, s[i], is_end[i]);
    }
    split_table(action, &action->tables.power, false, 1);
    split_table(action, &action->tables.slope, false, -1);
    split_table(action, &action->tables.second, false, 1);
    split_table(action, &action->tables.node_power, false, 1);
    split_table(action, &action->tables.weighted_power, true, 1);
    split_table(action, &action->tables.weighted_slope, true, -1);
    for (int k = 0; k <= action->q_degree && action->tables.by_parts; k++)
        for (int j = 0; j <= action->p_degree; j++)
            action->tables.by_parts[k * action->order_count + j] =
                j + k == 0 ? 0 : (j + k) * quadrature_error(order, points, s, weight, j + k - 1, span);
}
