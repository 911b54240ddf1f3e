/* action_tables.c - allocates a discrete action, and computes its tables: the powers of the quadrature's nodes, and the
 * derivatives of these powers. The tables depend only on the quadrature and on the ends of the step in scaled time.
 * Steppers call it when an integrator is made. */
#include "generating/action.h"
#include "algebra/quadrature.h"
#include "method/method.h"

/* Returns the number of nodes in each of the two halves of the step, which mirror each other. The number is padded to
 * whole vectors if the field's tape processes as many vectors with the padding as without; otherwise it is not
 * padded. */
static int choose_padded_half_node_count(const tvi_system *system, int points)
{
    const int lanes = 2 << system->field_values->sweeps->isa, half = (points + 1) / 2,
              whole = seeds_round_up_to_vectors(half);
    return (2 * whole + lanes - 1) / lanes > (2 * half + lanes - 1) / lanes ? half : whole;
}

tvi_action tvi_create_unallocated_action(const tvi_system *system, const tvi_options *options)
{
    const tvi_curve_definition *definition = &tvi_find_method(options)->curve;
    const int degree = options->degree, p_degree = definition->uses_highest_momentum_term ? degree : degree - 1;
    const int points = options->quadrature_points;
    const bool is_phase_space_action = definition->action == TVI_ACTION_HAMILTON,
               is_separable = system->form == TVI_SEPARABLE;
    const bool one_more = definition->uses_highest_momentum_term && is_separable; /* p of degree N needs Q_{N+1} */
    tvi_action sizes = {.is_phase_space_action = is_phase_space_action,
                        .omits_highest_order_at_nodes = options->nodes == TVI_NODES_TRUNCATED,
                        .has_gradient_by_v = !is_phase_space_action && !is_separable,
                        .has_gradient_by_p = is_phase_space_action && (!is_separable || p_degree >= degree),
                        .q_degree = degree,
                        .p_degree = p_degree,
                        .node_count = points,
                        .order_count = degree + one_more + 1};
    if (definition->step_span.start_s == -definition->step_span.end_s && seeds_need_no_second_derivatives(&sizes) &&
        tvi_quadrature_mirror(options->quadrature) == options->quadrature) {
        sizes.half_node_count = choose_padded_half_node_count(system, points);
        sizes.node_count = 2 * sizes.half_node_count;
    }
    return sizes;
}

const jet_tape *tvi_select_node_tape(const tvi_system *system, const tvi_action *action)
{
    return system->form == TVI_HAMILTONIAN && !action->is_phase_space_action ? system->field_series
                                                                             : system->field_values;
}

static void allocate_node_table(tvi_node_table *table, tvi_arena *arena, const tvi_action *action)
{
    const size_t half_rows = (size_t)seeds_round_up_to_vectors((action->order_count + 1) / 2) *
                             (size_t)seeds_round_up_to_vectors(action->half_node_count);
    table->values_of_all_orders = tvi_arena_allocate_doubles(arena, (size_t)(action->order_count * action->node_count));
    table->values_of_even_orders = tvi_arena_allocate_doubles(arena, half_rows);
    table->values_of_odd_orders = tvi_arena_allocate_doubles(arena, half_rows);
}

void tvi_allocate_action(tvi_action *action, tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    *action = tvi_create_unallocated_action(system, options);
    const size_t orders = (size_t)action->order_count, points = (size_t)action->node_count, n = (size_t)system->n;
    action->field_tape = tvi_select_node_tape(system, action);
    action->node_scaled_time = tvi_arena_allocate_doubles(arena, points);
    action->node_weight = tvi_arena_allocate_doubles(arena, points);
    tvi_node_table *const tables[] = {&action->power_table,
                                      &action->slope_table,
                                      &action->power_second_derivative_table,
                                      &action->power_table_truncated_by_node_rule,
                                      &action->weighted_power_table,
                                      &action->weighted_slope_table};
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) allocate_node_table(tables[i], arena, action);
    action->node_sums_by_order = tvi_arena_allocate_doubles(arena, orders);
    if (tvi_quadrature_order(options->quadrature, options->quadrature_points) < action->q_degree + action->p_degree)
        action->summation_by_parts_error = tvi_arena_allocate_doubles(arena, orders * orders);
    action->field_tape_values_at_nodes = tvi_arena_allocate_block(arena, action->field_tape, 1, action->node_count, 0);
    if (system->form == TVI_HAMILTONIAN && action->is_phase_space_action && action->omits_highest_order_at_nodes)
        action->hessian_product_block =
            tvi_arena_allocate_block(arena, system->r_dot_Hp_values, 1, action->node_count, 0);
    action->momentum_coefficients = tvi_arena_allocate_doubles(arena, orders * n);
    double **const panels[] = {&action->p_at_nodes, &action->dp_ds_at_nodes, &action->gradient_by_q,
                               &action->gradient_by_v, &action->gradient_by_p};
    for (size_t i = 0; i < sizeof panels / sizeof *panels; i++)
        *panels[i] = tvi_arena_allocate_doubles(arena, n * points);
    action->node_momentum_correction = tvi_arena_allocate_doubles(arena, n * points);
    if (action->field_tape != system->field_values) {
        action->H_pp = tvi_arena_allocate_doubles(arena, n * n * points);
        action->field_tangent_block =
            tvi_arena_allocate_doubles(arena, (size_t)action->field_tape->slot_count * points);
    }
    tvi_roundoff_allocate(&action->field_roundoff, arena, system);
}

/* Returns the quadrature of the function s^power over the span, less its integral; the result is exactly 0 if `power`
 * is below the order of the quadrature. */
static double compute_quadrature_error(int order, int points, const long double s[], const long double weight[],
                                       int power, tvi_step_span span)
{
    if (power < order) return 0;
    long double error = -(powl(span.end_s, power + 1) - powl(span.start_s, power + 1)) / (power + 1);
    for (int i = 0; i < points; i++) error += weight[i] * powl(s[i], power);
    return (double)error;
}

static void set_tables_of_node(tvi_action *action, int node, long double s, bool is_end_of_step)
{
    for (int k = 2; k < action->order_count; k++)
        action->power_second_derivative_table.values_of_all_orders[k * action->node_count + node] =
            (double)(k * (k - 1) * powl(s, k - 2));
    for (int k = 0; k <= action->q_degree; k++) {
        const int place = k * action->node_count + node, weighted = node * action->order_count + k;
        const bool left_out = action->omits_highest_order_at_nodes && k == action->q_degree && !is_end_of_step;
        const double power = (double)powl(s, k), slope = k == 0 ? 0 : k * (double)powl(s, k - 1);
        action->power_table.values_of_all_orders[place] = power;
        action->slope_table.values_of_all_orders[place] = slope;
        action->power_table_truncated_by_node_rule.values_of_all_orders[place] = left_out ? 0 : power;
        action->weighted_power_table.values_of_all_orders[weighted] = action->node_weight[node] * power;
        action->weighted_slope_table.values_of_all_orders[weighted] = action->node_weight[node] * slope;
    }
}

/* Copies the rows of the table's even orders and of its odd orders, at the first half of the nodes, from
 * values_of_all_orders to values_of_even_orders and values_of_odd_orders. */
static void split_table_by_order_parity(const tvi_action *action, tvi_node_table *table, bool is_weighted,
                                        double mirror_sign)
{
    const int half = action->half_node_count, orders = action->order_count,
              width = seeds_round_up_to_vectors((orders + 1) / 2);
    table->mirror_sign = mirror_sign;
    for (int k = 0; k < orders; k++)
        for (int node = 0; node < half; node++) {
            double *rows = k % 2 == 0 ? table->values_of_even_orders : table->values_of_odd_orders;
            if (is_weighted) rows[node * width + k / 2] = table->values_of_all_orders[node * orders + k];
            else rows[k / 2 * half + node] = table->values_of_all_orders[k * action->node_count + node];
        }
}

/* Returns the node of the quadrature rule at which this node of the action lies, and sets *share_of_node_weight to the
 * share of the rule's weight that the node of the action has. */
static int find_quadrature_node_of_action_node(const tvi_action *action, int quadrature_node_count, int action_node,
                                               double *share_of_node_weight)
{
    const int half = action->half_node_count, at = half > 0 ? action_node % half : action_node,
              node = at < (quadrature_node_count + 1) / 2 || half == 0 ? at : 0;
    *share_of_node_weight = node != at ? 0 : half > 0 && 2 * at + 1 == quadrature_node_count ? 0.5 : 1;
    return half > 0 && action_node >= half ? quadrature_node_count - 1 - node : node;
}

void tvi_prepare_action_tables(tvi_action *action, const tvi_options *options, tvi_step_span span)
{
    const int count = options->quadrature_points, order = tvi_quadrature_order(options->quadrature, count);
    long double s[TVI_MAX_POINTS], weight[TVI_MAX_POINTS];
    tvi_quadrature_compute_nodes(options->quadrature, count, s, weight);
    for (int point = 0; point < action->node_count; point++) {
        double share_of_node_weight;
        const int i = find_quadrature_node_of_action_node(action, count, point, &share_of_node_weight);
        const bool is_end_of_step = s[i] == -1 || s[i] == 1;
        /* Maps the node s[i] from [-1, 1] to the span. */
        const long double place = span.start_s + (span.end_s - span.start_s) * (1 + s[i]) / 2;
        action->node_scaled_time[point] = (double)place;
        action->node_weight[point] = share_of_node_weight * (double)(weight[i] * (span.end_s - span.start_s) / 2);
        set_tables_of_node(action, point, place, is_end_of_step);
    }
    for (int i = 0; i < count; i++) {
        s[i] = span.start_s + (span.end_s - span.start_s) * (1 + s[i]) / 2;
        weight[i] *= (span.end_s - span.start_s) / 2;
    }
    split_table_by_order_parity(action, &action->power_table, false, 1);
    split_table_by_order_parity(action, &action->slope_table, false, -1);
    split_table_by_order_parity(action, &action->power_second_derivative_table, false, 1);
    split_table_by_order_parity(action, &action->power_table_truncated_by_node_rule, false, 1);
    split_table_by_order_parity(action, &action->weighted_power_table, true, 1);
    split_table_by_order_parity(action, &action->weighted_slope_table, true, -1);
    if (!action->summation_by_parts_error) return;
    for (int k = 0; k <= action->q_degree; k++)
        for (int j = 0; j <= action->p_degree; j++)
            action->summation_by_parts_error[k * action->order_count + j] =
                j + k == 0 ? 0 : (j + k) * compute_quadrature_error(order, count, s, weight, j + k - 1, span);
}
