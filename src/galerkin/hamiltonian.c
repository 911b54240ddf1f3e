/* hamiltonian.c - Evaluates the field of a Hamiltonian K(q, p) = g h, with h = 0 on the solution, and its second
 * derivatives, for Newton's method (docs/method.md section 5). The system has them if they take little time compared
 * with K, as those of a rescaled system do (system/hessian.c).
 *
 * A pass evaluates the gradient (K_q, K_p) at x = (Q, P), and its derivatives, too. The movement by this gradient is
 * d_0. If the gradient were its expansion to first order, the next movements of a fixed-point iteration would be
 *
 *    d_{k+1} = (step size) a J K'' d_k,    J (K_q, K_p) = (K_p, -K_q).
 *
 * Each of them is an inner round, which takes a small part of the time of an evaluation. The pass ends with a movement
 * by the gradient, expanded to first order, at x + sum_k d_k. */
#include "galerkin/hamiltonian_passes.h"
#include "galerkin/model.h"

typedef struct {
    hamiltonian_passes passes;
    galerkin_hessian_tables hessian_tables;
    /* The arrays to which the members of `passes` with these names point. */
    int *rate_slot[2], *unknown_of_row, *hessian_index;
} hamiltonian_work;

static void allocate_inner_rounds(lanes_inner_rounds *rounds, tvi_arena *arena, size_t rows, size_t lanes)
{
    rounds->impulse_matrix = tvi_arena_allocate(arena, lanes * lanes * sizeof *rounds->impulse_matrix);
    rounds->packed_hessian = tvi_arena_allocate(arena, rows * rows * lanes * sizeof *rounds->packed_hessian);
    rounds->unknown_size = tvi_arena_allocate_doubles(arena, rows);
    rounds->inverse_unknown_size = tvi_arena_allocate_doubles(arena, rows);
    float **const vectors[] = {&rounds->round_change, &rounds->total_change, &rounds->round_impulse,
                               &rounds->total_impulse};
    for (size_t i = 0; i < 4; i++) *vectors[i] = tvi_arena_allocate(arena, rows * lanes * sizeof(float));
}

static void allocate_hamiltonian_field(galerkin_field *field, tvi_arena *arena)
{
    const size_t unknowns = (size_t)field->nodes.unknowns, lanes = (size_t)field->nodes.lanes;
    hamiltonian_work *taken = field->form_work = tvi_arena_allocate(arena, sizeof *taken);
    hamiltonian_work work = {.passes = {.kernels = field->kernels}};
    field->pass_input_row_count = field->nodes.unknowns;
    field->nodes.values = tvi_arena_allocate_doubles(arena, 2 * unknowns * lanes);
    tvi_galerkin_allocate_hessian_tables(&work.hessian_tables, arena, field);
    field->tape_block = work.hessian_tables.blocks.values_block;
    field->rate_to_unknown = tvi_arena_allocate_doubles(arena, lanes * lanes);
    work.passes.rate_nodes = field->nodes;
    work.passes.rate_nodes.values = field->nodes.values ? field->nodes.values + unknowns * lanes : NULL;
    work.passes.rate_nodes.drift_values = work.passes.rate_nodes.drift_values_low =
        tvi_arena_allocate_doubles(arena, unknowns * lanes);
    work.passes.rate_nodes.impulse_scale = tvi_arena_allocate_doubles(arena, unknowns);
    work.passes.rounds.unknown_of_row = work.unknown_of_row = tvi_arena_allocate(arena, unknowns * sizeof(int));
    work.passes.rounds.hessian_index = work.hessian_index =
        tvi_arena_allocate(arena, unknowns * unknowns * sizeof(int));
    allocate_inner_rounds(&work.passes.rounds, arena, unknowns, lanes);
    work.passes.impulse_changes = tvi_arena_allocate_doubles(arena, unknowns * lanes);
    for (int i = 0; i < 2; i++)
        work.passes.rate_slot[i] = work.rate_slot[i] = tvi_arena_allocate(arena, unknowns * sizeof(int));
    if (taken) *taken = work;
}

/* Returns the component of the gradient that is the rate of an unknown, up to its sign. */
static int find_gradient_component(const galerkin_field *field, int unknown)
{
    const int n = field->system->n;
    return unknown < n ? unknown + n : unknown - n;
}

static int find_row_begin(const galerkin_hessian_tables *tables, int row)
{
    return row > 0 ? tables->row_end[row - 1] : 0;
}

static bool has_row_entries(const galerkin_hessian_tables *tables, int row)
{
    return find_row_begin(tables, row) < tables->row_end[row];
}

/* Returns whether an unknown takes part in the inner rounds: its rate depends on unknowns, so that it moves, and
 * some rate depends on it. Two unknowns do not: a cyclic coordinate moves, but no rate depends on it, and its
 * momentum is constant. */
static bool is_unknown_in_rounds(const galerkin_field *field, const galerkin_hessian_tables *tables, int unknown)
{
    return has_row_entries(tables, unknown) && has_row_entries(tables, find_gradient_component(field, unknown));
}

/* Returns the index of a second derivative in hessian_block. If the derivative is 0 by construction, this is the
 * index of the row of zeros after the block. */
static int find_hessian_index(const galerkin_field *field, const galerkin_hessian_tables *tables, int row, int column)
{
    int slot = field->system->hessian_values->slots;
    for (int k = find_row_begin(tables, row); k < tables->row_end[row]; k++)
        if (tables->hessian_element[k].column == column) slot = tables->hessian_element[k].slot;
    return slot * field->nodes.lanes;
}

/* Appends to `list`, which has `count` elements, the unknowns whose rates depend on unknowns: those that take part
 * in the rounds if in_rounds is set, otherwise those that do not. Returns the new length of the list. */
static int append_unknowns_with_row(const galerkin_field *field, const galerkin_hessian_tables *tables, bool in_rounds,
                                    int count, int *list)
{
    for (int u = 0; u < field->nodes.unknowns; u++)
        if (has_row_entries(tables, find_gradient_component(field, u)) &&
            is_unknown_in_rounds(field, tables, u) == in_rounds)
            list[count++] = u;
    return count;
}

/* Lists the indices of the matrix elements, one group of rows after the other. */
static void list_hessian_indices(const galerkin_field *field, const galerkin_hessian_tables *tables,
                                 const lanes_inner_rounds *rounds, int *index)
{
    for (int first = 0; first < rounds->row_count; first += LANES_ROWS)
        for (int column = 0; column < rounds->column_count; column++)
            for (int i = first; i < first + lanes_row_group_size(rounds, first); i++)
                *index++ = find_hessian_index(field, tables, find_gradient_component(field, rounds->unknown_of_row[i]),
                                              rounds->unknown_of_row[column]);
}

static void prepare_inner_rounds(const galerkin_field *field, const hamiltonian_work *work, lanes_inner_rounds *rounds)
{
    const galerkin_hessian_tables *tables = &work->hessian_tables;
    int *unknown = work->unknown_of_row;
    rounds->column_count = append_unknowns_with_row(field, tables, true, 0, unknown);
    rounds->row_count = append_unknowns_with_row(field, tables, false, rounds->column_count, unknown);
    rounds->hessian_block = tables->blocks.hessian_block;
    for (int i = 0; i < field->nodes.lanes * field->nodes.lanes; i++)
        rounds->impulse_matrix[i] = (float)field->impulse_matrix[i];
    list_hessian_indices(field, tables, rounds, work->hessian_index);
}

static void prepare_hamiltonian_field(galerkin_field *field)
{
    hamiltonian_work *work = field->form_work;
    hamiltonian_passes *passes = &work->passes;
    tvi_galerkin_prepare_hessian_tables(&work->hessian_tables, field);
    prepare_inner_rounds(field, work, &passes->rounds);
    for (int u = 0; u < field->nodes.unknowns; u++) {
        field->rate_row[u] = field->nodes.unknowns + u;
        work->rate_slot[false][u] = field->system->field_values->output_slot[find_gradient_component(field, u)];
        work->rate_slot[true][u] = field->system->hessian_values->output_slot[find_gradient_component(field, u)];
    }
    passes->nodes = &field->nodes;
    passes->impulse_matrix = field->impulse_matrix;
    passes->rate_row = field->rate_row;
    passes->tape_blocks = work->hessian_tables.blocks;
}

static tvi_status predict_hamiltonian_from_start(galerkin_field *field, const tvi_step_origin *origin)
{
    hamiltonian_work *work = field->form_work;
    const galerkin_nodes *nodes = &field->nodes;
    const int lanes = nodes->lanes, *slot = work->rate_slot[false];
    (void)origin;
    for (int u = 0; u < nodes->unknowns; u++)
        for (int i = 0; i < lanes; i++) nodes->values[u * lanes + i] = nodes->start_values[u];
    work->passes.last_movement = INFINITY;
    const double *momenta = nodes->values + field->system->n * lanes;
    const double *rates = galerkin_evaluate_gradient_at_nodes(&work->passes.tape_blocks, tvi_galerkin_sweep_tape, false,
                                                              nodes->values, momenta);
    if (!rates) return TVI_EDOMAIN;
    for (int u = 0; u < nodes->unknowns; u++)
        memcpy(nodes->values + field->rate_row[u] * lanes, rates + slot[u] * lanes, (size_t)lanes * sizeof *rates);
    (void)galerkin_move_unknowns(field);
    return TVI_OK;
}

static void predict_hamiltonian_unknowns(galerkin_field *field, const galerkin_extrapolation *extrapolation)
{
    hamiltonian_work *work = field->form_work;
    hamiltonian_predict_unknowns(&work->passes, &field->nodes, extrapolation);
}

static tvi_status make_hamiltonian_pass(galerkin_field *field, double *movement, tvi_stats *stats)
{
    hamiltonian_work *work = field->form_work;
    (void)stats;
    if (!hamiltonian_make_pass(&work->passes, tvi_galerkin_sweep_tape)) return TVI_EDOMAIN;
    *movement = work->passes.last_movement;
    return TVI_OK;
}

static void emit_hamiltonian_field(jet_text *text, const galerkin_field *field)
{
    const hamiltonian_work *work = field->form_work;
    const lanes_inner_rounds *rounds = &work->passes.rounds;
    const int unknowns = field->nodes.unknowns;
    tvi_galerkin_emit_hessian_tables(text, &work->hessian_tables);
    jet_text_append(text, "enum { GALERKIN_COLUMNS = %d, GALERKIN_ROWS = %d };\n", rounds->column_count,
                    rounds->row_count);
    tvi_galerkin_emit_int_array(text, "value_slot", unknowns, work->rate_slot[false]);
    tvi_galerkin_emit_int_array(text, "hessian_slot", unknowns, work->rate_slot[true]);
    tvi_galerkin_emit_int_array(text, "unknown", rounds->row_count, rounds->unknown_of_row);
    tvi_galerkin_emit_int_array(text, "index_of", rounds->row_count * rounds->column_count, rounds->hessian_index);
    tvi_galerkin_emit_int_array(text, "slot", unknowns, field->rate_row);
}

const galerkin_field_form tvi_galerkin_form_hamiltonian = {
    allocate_hamiltonian_field,       prepare_hamiltonian_field, predict_hamiltonian_from_start,
    predict_hamiltonian_unknowns,     make_hamiltonian_pass,     emit_hamiltonian_field,
    tvi_embedded_galerkin_hamiltonian};
