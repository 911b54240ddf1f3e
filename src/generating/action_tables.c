/* action_tables.c - the memory of an action, and the tables that its quadrature and its span decide. */
#include "generating/action.h"
#include "algebra/quadrature.h"

#include <math.h>
#include <string.h>

static bool sums_by_parts_exactly(const tvi_action *action, const tvi_options *options)
{
    return tvi_quadrature_order(options->quadrature, options->quadrature_points) >= action->q_degree + action->p_degree;
}

tvi_action tvi_action_shape(const tvi_system *system, const tvi_options *options, tvi_action_kind kind, int q_degree,
                            int p_degree, int top)
{
    const bool is_hamilton = kind == TVI_ACTION_HAMILTON, is_separable = system->form == TVI_SEPARABLE;
    return (tvi_action){.is_hamilton = is_hamilton,
                        .truncated = options->nodes == TVI_NODES_TRUNCATED,
                        .has_velocity_defect = !is_hamilton && !is_separable,
                        .has_momentum_defect = is_hamilton && (!is_separable || p_degree >= q_degree),
                        .q_degree = q_degree,
                        .p_degree = p_degree,
                        .points = options->quadrature_points,
                        .orders = top + 1};
}

void tvi_action_take(tvi_action *action, tvi_arena *arena, const tvi_system *system, const tvi_options *options,
                     tvi_action_kind kind, int q_degree, int p_degree, int top)
{
    const size_t orders = (size_t)top + 1, points = (size_t)options->quadrature_points, n = (size_t)system->n;
    *action = tvi_action_shape(system, options, kind, q_degree, p_degree, top);
    action->sweeps = system->field_values->sweeps;
    action->s = tvi_arena_doubles(arena, points);
    action->weight = tvi_arena_doubles(arena, points);
    action->power = tvi_arena_doubles(arena, orders * points);
    action->slope = tvi_arena_doubles(arena, orders * points);
    action->second_slope = tvi_arena_doubles(arena, orders * points);
    action->node_power = tvi_arena_doubles(arena, orders * points);
    action->weighted_power = tvi_arena_doubles(arena, orders * points);
    action->weighted_slope = tvi_arena_doubles(arena, orders * points);
    action->row = tvi_arena_doubles(arena, orders);
    if (!sums_by_parts_exactly(action, options)) action->by_parts = tvi_arena_doubles(arena, orders * orders);
    action->x = tvi_arena_block(arena, system->field_values, 1, action->points, 0);
    if (system->form == TVI_HAMILTONIAN && kind == TVI_ACTION_HAMILTON && action->truncated)
        action->bend = tvi_arena_block(arena, system->bend_values, 1, action->points, 0);
    action->P = tvi_arena_doubles(arena, orders * n);
    double **const panels[] = {&action->momentum, &action->force, &action->on_q, &action->on_v, &action->on_p};
    for (size_t i = 0; i < sizeof panels / sizeof *panels; i++) *panels[i] = tvi_arena_doubles(arena, n * points);
    action->correction = tvi_arena_doubles(arena, n);
    tvi_roundoff_take(&action->roundoff, arena, system);
}

/* The error of the quadrature for s^r on the span; exactly 0 below its order. */
static double quadrature_error(int order, int points, const long double s[], const long double weight[], int r,
                               tvi_span span)
{
    if (r < order) return 0;
    long double error = -(powl(span.to, r + 1) - powl(span.from, r + 1)) / (r + 1);
    for (int i = 0; i < points; i++) error += weight[i] * powl(s[i], r);
    return (double)error;
}

static void fill_powers(tvi_action *action, int node, long double s, bool at_end)
{
    for (int k = 2; k < action->orders; k++)
        action->second_slope[k * action->points + node] = (double)(k * (k - 1) * powl(s, k - 2));
    for (int k = 0; k <= action->q_degree; k++) {
        const int place = k * action->points + node;
        const bool left_out = action->truncated && k == action->q_degree && !at_end;
        action->power[place] = (double)powl(s, k);
        action->slope[place] = k == 0 ? 0 : k * (double)powl(s, k - 1);
        action->node_power[place] = left_out ? 0 : action->power[place];
        action->weighted_power[node * action->orders + k] = action->weight[node] * action->power[place];
        action->weighted_slope[node * action->orders + k] = action->weight[node] * action->slope[place];
    }
}

void tvi_action_prepare(tvi_action *action, const tvi_options *options, tvi_span span, int top)
{
    const int points = action->points, order = tvi_quadrature_order(options->quadrature, points);
    long double s[TVI_MAX_POINTS], weight[TVI_MAX_POINTS];
    tvi_quadrature_nodes(options->quadrature, points, s, weight);
    for (int i = 0; i < points; i++) { /* from [-1, 1] to the span */
        const bool at_end = s[i] == -1 || s[i] == 1;
        s[i] = span.from + (span.to - span.from) * (1 + s[i]) / 2;
        weight[i] *= (span.to - span.from) / 2;
        action->s[i] = (double)s[i];
        action->weight[i] = (double)weight[i];
        fill_powers(action, i, s[i], at_end);
    }
    if (!action->by_parts) return;
    for (int k = 0; k <= action->q_degree; k++)
        for (int j = 0; j <= action->p_degree; j++)
            action->by_parts[k * (top + 1) + j] =
                j + k == 0 ? 0 : (j + k) * quadrature_error(order, points, s, weight, j + k - 1, span);
}
