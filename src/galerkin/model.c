/* model.c - Prepares the blocks of numbers in which the field's gradient and its second derivatives are evaluated, and
 * lists the second derivatives that are not 0 (model.h). */
#include "galerkin/model.h"

void tvi_galerkin_allocate_sparse_hessian(galerkin_sparse_hessian *sparse_hessian, tvi_arena *arena,
                                          const galerkin_equations *equations)
{
    const tvi_system *system = equations->system;
    const size_t lanes = (size_t)equations->nodes.lane_count;
    sparse_hessian->derivative_tapes = (galerkin_derivative_tapes){.coordinate_count = system->n,
                                                                   .lane_count = equations->nodes.lane_count,
                                                                   .input_count = system->hessian_values->input_count};
    sparse_hessian->derivative_tapes.gradient_block =
        tvi_arena_allocate_block(arena, system->field_values, 1, equations->nodes.lane_count, 0);
    sparse_hessian->derivative_tapes.hessian_block =
        tvi_arena_allocate_block(arena, system->hessian_values, 1, equations->nodes.lane_count, lanes);
    sparse_hessian->hessian_element =
        tvi_arena_allocate(arena, 2 * (size_t)system->hessian_entry_count * sizeof *sparse_hessian->hessian_element);
    sparse_hessian->row_end = tvi_arena_allocate(arena, 2 * (size_t)system->n * sizeof *sparse_hessian->row_end);
}

/* Lists the elements of each row of the symmetric Hessian. Columns of the second half come first, since V moves
 * before Q. */
static void list_hessian_row_elements(const tvi_system *system, lanes_hessian_element *element, int *row_end)
{
    const int rows = 2 * system->n;
    for (int k = 0; k < system->hessian_entry_count; k++) {
        row_end[system->hessian[k].row]++;
        if (system->hessian[k].row != system->hessian[k].column) row_end[system->hessian[k].column]++;
    }
    /* This loop sets row_end to the beginning of each row. The next loop advances it to the end. */
    for (int i = 0, before = 0; i < rows; i++) {
        const int count = row_end[i];
        row_end[i] = before;
        before += count;
    }
    for (int half = 1; half >= 0; half--)
        for (int k = 0; k < system->hessian_entry_count; k++) {
            const int i = system->hessian[k].row, j = system->hessian[k].column;
            const int slot = system->hessian_values->output_slot[rows + k];
            if (j / system->n == half) element[row_end[i]++] = (lanes_hessian_element){j, slot};
            if (i != j && i / system->n == half) element[row_end[j]++] = (lanes_hessian_element){i, slot};
        }
}

void tvi_galerkin_set_sparse_hessian_tables(galerkin_sparse_hessian *sparse_hessian,
                                            const galerkin_equations *equations)
{
    const tvi_system *system = equations->system;
    const int lanes = equations->nodes.lane_count;
    list_hessian_row_elements(system, sparse_hessian->hessian_element, sparse_hessian->row_end);
    for (int i = 0; i < lanes; i++) {
        const int node = i < equations->node_count ? i : equations->node_count - 1;
        equations->impulse_to_predicted_unknown_or_rate_matrix[node * lanes + i] = 1 / equations->node_weight[node];
    }
    sparse_hessian->derivative_tapes.galerkin_equations_for_sweep = equations;
}

bool tvi_galerkin_sweep_tape(const galerkin_derivative_tapes *tapes, bool with_hessian)
{
    const galerkin_equations *equations = tapes->galerkin_equations_for_sweep;
    const jet_tape *tape = with_hessian ? equations->system->hessian_values : equations->system->field_values;
    double *x = with_hessian ? tapes->hessian_block : tapes->gradient_block;
    if (!jet_sweep_values(tape, x, tapes->lane_count)) return false;
    if (equations->tape_output_roundoff_to_add) tvi_galerkin_perturb_tape_outputs_by_roundoff(equations, tape, x);
    return true;
}

void tvi_galerkin_emit_sparse_hessian(jet_text *text, const galerkin_sparse_hessian *sparse_hessian)
{
    const galerkin_equations *equations = sparse_hessian->derivative_tapes.galerkin_equations_for_sweep;
    const jet_tape *hessian = equations->system->hessian_values;
    const int rows = 2 * sparse_hessian->derivative_tapes.coordinate_count;
    tvi_galerkin_emit_int_array(text, "row_end", rows, sparse_hessian->row_end);
    jet_text_append(text, "static const lanes_hessian_element galerkin_hessian_element[] = {");
    for (int k = 0; k < sparse_hessian->row_end[rows - 1]; k++)
        jet_text_append(text, "{%d, %d}, ", sparse_hessian->hessian_element[k].column,
                        sparse_hessian->hessian_element[k].slot);
    jet_text_append(text,
                    "{0}};\nenum { GALERKIN_INPUTS = %d, GALERKIN_HESSIAN_READ_ONLY_ROWS = %d };\n"
                    "#define GALERKIN_HESSIAN_VALUES(x) tvi_hessian_values_%d(x)\n",
                    hessian->input_count, galerkin_count_input_and_constant_rows(hessian),
                    sparse_hessian->derivative_tapes.lane_count);
}
