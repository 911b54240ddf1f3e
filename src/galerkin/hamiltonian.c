/* hamiltonian.c - Evaluates the field of a Hamiltonian K(q, p) and its second derivatives at the nodes, for Newton's
 * method (docs/method.md section 5). For a rescaled system K is g h, where h = H + e is 0 on the solution. A system has
 * a tape of second derivatives only if they take little time compared with K, as those of a rescaled system do
 * (system/hessian.c).
 *
 * A pass evaluates the gradient (K_q, K_p) at the unknowns x = (Q, P), and the matrix K'' of its derivatives, too. One
 * fixed-point iteration with this gradient would move x by d_0. If the gradient were its expansion to first order, the
 * next iterations would move x by
 *
 *     d_{k+1} = (step size) a J K'' d_k,    J (K_q, K_p) = (K_p, -K_q),
 *
 * with the matrix a of Gauss collocation. The computation of one d_k is an inner iteration, which takes a small part of
 * the time of an evaluation. The pass ends with a movement by the gradient, expanded to first order, at x + sum_k
 * d_k. */
#include "galerkin/hamiltonian_passes.h"
#include "galerkin/model.h"

typedef struct {
    hamiltonian_pass_context pass_context;
    galerkin_sparse_hessian sparse_hessian;
    /* The arrays to which the fields of the same names point in pass_context and in its newton_inner_iteration_data. */
    int *tape_slot_of_rate[2], *unknown_of_row, *index_in_hessian_block;
} hamiltonian_work;

static void allocate_inner_iterations(lanes_inner_iterations *inner, tvi_arena *arena, size_t rows, size_t lanes)
{
    inner->impulse_to_unknown_change_matrix =
        tvi_arena_allocate(arena, lanes * lanes * sizeof *inner->impulse_to_unknown_change_matrix);
    inner->packed_hessian = tvi_arena_allocate(arena, rows * rows * lanes * sizeof *inner->packed_hessian);
    inner->unknown_size = tvi_arena_allocate_doubles(arena, rows);
    inner->inverse_unknown_size = tvi_arena_allocate_doubles(arena, rows);
    float **const vectors[] = {&inner->last_unknown_change, &inner->total_unknown_change, &inner->last_impulse_change,
                               &inner->total_impulse_change};
    for (size_t i = 0; i < 4; i++) *vectors[i] = tvi_arena_allocate(arena, rows * lanes * sizeof(float));
}

static void allocate_hamiltonian_equations(galerkin_equations *equations, tvi_arena *arena)
{
    const size_t unknowns = (size_t)equations->nodes.unknown_count, lanes = (size_t)equations->nodes.lane_count;
    hamiltonian_work *taken = equations->lagrangian_or_hamiltonian_pass_workspace =
        tvi_arena_allocate(arena, sizeof *taken);
    hamiltonian_work work = {.pass_context = {.kernels = equations->kernels}};
    equations->node_value_row_count_read_by_pass = equations->nodes.unknown_count;
    equations->nodes.values = tvi_arena_allocate_doubles(arena, 2 * unknowns * lanes);
    tvi_galerkin_allocate_sparse_hessian(&work.sparse_hessian, arena, equations);
    equations->tape_block = work.sparse_hessian.derivative_tapes.gradient_block;
    equations->impulse_to_predicted_unknown_or_rate_matrix = tvi_arena_allocate_doubles(arena, lanes * lanes);
    work.pass_context.nodes_with_rates_as_unknowns = equations->nodes;
    work.pass_context.nodes_with_rates_as_unknowns.values =
        equations->nodes.values ? equations->nodes.values + unknowns * lanes : NULL;
    work.pass_context.nodes_with_rates_as_unknowns.drift_values =
        work.pass_context.nodes_with_rates_as_unknowns.drift_values_low =
            tvi_arena_allocate_doubles(arena, unknowns * lanes);
    work.pass_context.nodes_with_rates_as_unknowns.unknown_change_per_impulse = equations->rate_per_impulse;
    work.pass_context.newton_inner_iteration_data.unknown_of_row = work.unknown_of_row =
        tvi_arena_allocate(arena, unknowns * sizeof(int));
    work.pass_context.newton_inner_iteration_data.index_in_hessian_block = work.index_in_hessian_block =
        tvi_arena_allocate(arena, unknowns * unknowns * sizeof(int));
    allocate_inner_iterations(&work.pass_context.newton_inner_iteration_data, arena, unknowns, lanes);
    work.pass_context.change_of_step_impulses_by_inner_iterations = tvi_arena_allocate_doubles(arena, unknowns * lanes);
    for (int i = 0; i < 2; i++)
        work.pass_context.tape_slot_of_rate[i] = work.tape_slot_of_rate[i] =
            tvi_arena_allocate(arena, unknowns * sizeof(int));
    if (taken) *taken = work;
}

/* Returns the component of the gradient that is the rate of an unknown, up to its sign. */
static int find_gradient_component_of_rate(const galerkin_equations *equations, int unknown)
{
    const int n = equations->system->n;
    return unknown < n ? unknown + n : unknown - n;
}

static int find_hessian_row_begin(const galerkin_sparse_hessian *sparse_hessian, int row)
{
    return row > 0 ? sparse_hessian->row_end[row - 1] : 0;
}

static bool has_hessian_row_entries(const galerkin_sparse_hessian *sparse_hessian, int row)
{
    return find_hessian_row_begin(sparse_hessian, row) < sparse_hessian->row_end[row];
}

/* Returns whether an unknown takes part in the inner iterations: its rate depends on unknowns, so that it moves, and
 * some rate depends on it. A cyclic coordinate and its momentum take no part: no rate depends on the coordinate, and
 * the momentum is constant. */
static bool is_unknown_in_inner_iterations(const galerkin_equations *equations,
                                           const galerkin_sparse_hessian *sparse_hessian, int unknown)
{
    return has_hessian_row_entries(sparse_hessian, unknown) &&
           has_hessian_row_entries(sparse_hessian, find_gradient_component_of_rate(equations, unknown));
}

/* Returns the index of the second derivative (row, column) in hessian_block. If the derivative is 0 by construction,
 * the result is the index of the row of zeros after the block. */
static int find_index_in_hessian_block(const galerkin_equations *equations,
                                       const galerkin_sparse_hessian *sparse_hessian, int row, int column)
{
    int slot = equations->system->hessian_values->slot_count;
    for (int k = find_hessian_row_begin(sparse_hessian, row); k < sparse_hessian->row_end[row]; k++)
        if (sparse_hessian->hessian_element[k].column == column) slot = sparse_hessian->hessian_element[k].slot;
    return slot * equations->nodes.lane_count;
}

/* Appends to `unknown_list`, which has `count` elements, the unknowns whose rates depend on unknowns: those that take
 * part in the inner iterations if in_inner_iterations is set, otherwise those that do not. Returns the new length of
 * the list. */
static int append_unknowns_in_or_outside_inner_iterations(const galerkin_equations *equations,
                                                          const galerkin_sparse_hessian *sparse_hessian,
                                                          bool in_inner_iterations, int count, int *unknown_list)
{
    for (int u = 0; u < equations->nodes.unknown_count; u++)
        if (has_hessian_row_entries(sparse_hessian, find_gradient_component_of_rate(equations, u)) &&
            is_unknown_in_inner_iterations(equations, sparse_hessian, u) == in_inner_iterations)
            unknown_list[count++] = u;
    return count;
}

/* Lists the index in hessian_block of each element of the matrix K'' by which inner iterations multiply. The order is
 * that in which the kernel reads the elements: by groups of LANES_ROWS_PER_GROUP rows, which it sums in parallel, and
 * column by column in each group. */
static void list_indices_in_hessian_block(const galerkin_equations *equations,
                                          const galerkin_sparse_hessian *sparse_hessian,
                                          const lanes_inner_iterations *inner, int *index)
{
    for (int first = 0; first < inner->hessian_row_count; first += LANES_ROWS_PER_GROUP)
        for (int column = 0; column < inner->hessian_column_count; column++)
            for (int i = first; i < first + lanes_count_rows_summed_in_parallel(inner, first); i++)
                *index++ = find_index_in_hessian_block(
                    equations, sparse_hessian, find_gradient_component_of_rate(equations, inner->unknown_of_row[i]),
                    inner->unknown_of_row[column]);
}

static void set_tables_of_inner_iterations(const galerkin_equations *equations, const hamiltonian_work *work,
                                           lanes_inner_iterations *inner)
{
    const galerkin_sparse_hessian *sparse_hessian = &work->sparse_hessian;
    int *unknown = work->unknown_of_row;
    inner->hessian_column_count =
        append_unknowns_in_or_outside_inner_iterations(equations, sparse_hessian, true, 0, unknown);
    inner->hessian_row_count = append_unknowns_in_or_outside_inner_iterations(equations, sparse_hessian, false,
                                                                              inner->hessian_column_count, unknown);
    inner->hessian_block = sparse_hessian->derivative_tapes.hessian_block;
    for (int i = 0; i < equations->nodes.lane_count * equations->nodes.lane_count; i++)
        inner->impulse_to_unknown_change_matrix[i] = (float)equations->node_impulse_to_node_unknown_matrix[i];
    list_indices_in_hessian_block(equations, sparse_hessian, inner, work->index_in_hessian_block);
}

static void set_tables_of_hamiltonian_equations(galerkin_equations *equations)
{
    hamiltonian_work *work = equations->lagrangian_or_hamiltonian_pass_workspace;
    hamiltonian_pass_context *context = &work->pass_context;
    tvi_galerkin_set_sparse_hessian_tables(&work->sparse_hessian, equations);
    set_tables_of_inner_iterations(equations, work, &context->newton_inner_iteration_data);
    for (int u = 0; u < equations->nodes.unknown_count; u++) {
        equations->rate_row_of_unknown[u] = equations->nodes.unknown_count + u;
        work->tape_slot_of_rate[false][u] =
            equations->system->field_values->output_slot[find_gradient_component_of_rate(equations, u)];
        work->tape_slot_of_rate[true][u] =
            equations->system->hessian_values->output_slot[find_gradient_component_of_rate(equations, u)];
    }
    context->nodes = &equations->nodes;
    context->node_impulse_to_node_unknown_matrix = equations->node_impulse_to_node_unknown_matrix;
    context->rate_row_of_unknown = equations->rate_row_of_unknown;
    context->derivative_tapes = work->sparse_hessian.derivative_tapes;
}

static tvi_status predict_hamiltonian_unknowns_from_start(galerkin_equations *equations, const tvi_step_origin *origin)
{
    hamiltonian_work *work = equations->lagrangian_or_hamiltonian_pass_workspace;
    const galerkin_nodes *nodes = &equations->nodes;
    const int lanes = nodes->lane_count, *slot = work->tape_slot_of_rate[false];
    (void)origin;
    for (int u = 0; u < nodes->unknown_count; u++)
        for (int i = 0; i < lanes; i++) nodes->values[u * lanes + i] = nodes->start_values[u];
    work->pass_context.last_pass_movement_square = INFINITY;
    const double *momenta = nodes->values + equations->system->n * lanes;
    const double *rates = galerkin_evaluate_gradient_at_nodes(&work->pass_context.derivative_tapes,
                                                              tvi_galerkin_sweep_tape, false, nodes->values, momenta);
    if (!rates) return TVI_EDOMAIN;
    for (int u = 0; u < nodes->unknown_count; u++)
        memcpy(nodes->values + equations->rate_row_of_unknown[u] * lanes, rates + slot[u] * lanes,
               (size_t)lanes * sizeof *rates);
    (void)galerkin_move_unknowns_sum_squared_changes(equations);
    return TVI_OK;
}

static tvi_status make_hamiltonian_pass(galerkin_equations *equations, double *movement, tvi_stats *stats)
{
    hamiltonian_work *work = equations->lagrangian_or_hamiltonian_pass_workspace;
    (void)stats;
    if (!hamiltonian_make_pass(&work->pass_context, tvi_galerkin_sweep_tape)) return TVI_EDOMAIN;
    *movement = work->pass_context.last_pass_movement_square;
    return TVI_OK;
}

static void emit_hamiltonian_equations(jet_text *text, const galerkin_equations *equations)
{
    const hamiltonian_work *work = equations->lagrangian_or_hamiltonian_pass_workspace;
    const lanes_inner_iterations *inner = &work->pass_context.newton_inner_iteration_data;
    const int unknowns = equations->nodes.unknown_count;
    tvi_galerkin_emit_sparse_hessian(text, &work->sparse_hessian);
    jet_text_append(text, "enum { GALERKIN_HESSIAN_COLUMNS = %d, GALERKIN_HESSIAN_ROWS = %d };\n",
                    inner->hessian_column_count, inner->hessian_row_count);
    tvi_galerkin_emit_int_array(text, "value_slot", unknowns, work->tape_slot_of_rate[false]);
    tvi_galerkin_emit_int_array(text, "hessian_slot", unknowns, work->tape_slot_of_rate[true]);
    tvi_galerkin_emit_int_array(text, "unknown_of_row", inner->hessian_row_count, inner->unknown_of_row);
    tvi_galerkin_emit_int_array(text, "index_in_hessian_block", inner->hessian_row_count * inner->hessian_column_count,
                                inner->index_in_hessian_block);
    tvi_galerkin_emit_int_array(text, "rate_row_of_unknown", unknowns, equations->rate_row_of_unknown);
}

const galerkin_field_form tvi_galerkin_form_hamiltonian = {allocate_hamiltonian_equations,
                                                           set_tables_of_hamiltonian_equations,
                                                           predict_hamiltonian_unknowns_from_start,
                                                           hamiltonian_predict_unknowns,
                                                           make_hamiltonian_pass,
                                                           emit_hamiltonian_equations,
                                                           tvi_embedded_galerkin_hamiltonian};
