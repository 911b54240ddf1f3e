/* model.c - Prepares the second derivatives at the nodes (model.h). */
#include "galerkin/model.h"

void tvi_galerkin_model_take(galerkin_model *model, tvi_arena *arena, const galerkin_field *field)
{
    const tvi_system *system = field->system;
    const size_t lanes = (size_t)field->nodes.lanes;
    model->blocks =
        (galerkin_blocks){.n = system->n, .lanes = field->nodes.lanes, .inputs = system->hessian_values->inputs};
    model->blocks.values = tvi_arena_allocate_block(arena, system->field_values, 1, field->nodes.lanes, 0);
    model->blocks.hessian = tvi_arena_allocate_block(arena, system->hessian_values, 1, field->nodes.lanes, lanes);
    model->lanes.moved = tvi_arena_doubles(arena, 2 * (size_t)system->n * lanes);
    model->term = tvi_arena_allocate(arena, 2 * (size_t)system->hessian_entries * sizeof *model->term);
    model->end = tvi_arena_allocate(arena, 2 * (size_t)system->n * sizeof *model->end);
}

/* Lists the rows of the symmetric matrix of second derivatives. Columns of the second half come first, as V moves
 * before Q. */
static void set_terms(const tvi_system *system, lanes_term *term, int *end)
{
    const int rows = 2 * system->n;
    for (int k = 0; k < system->hessian_entries; k++) {
        end[system->hessian[k].row]++;
        if (system->hessian[k].row != system->hessian[k].column) end[system->hessian[k].column]++;
    }
    for (int i = 0, before = 0; i < rows; i++) { /* where the row begins; below, it moves on to the row's end */
        const int count = end[i];
        end[i] = before;
        before += count;
    }
    for (int half = 1; half >= 0; half--)
        for (int k = 0; k < system->hessian_entries; k++) {
            const int i = system->hessian[k].row, j = system->hessian[k].column;
            const int slot = system->hessian_values->output[rows + k];
            if (j / system->n == half) term[end[i]++] = (lanes_term){j, slot};
            if (i != j && i / system->n == half) term[end[j]++] = (lanes_term){i, slot};
        }
}

void tvi_galerkin_model_prepare(galerkin_model *model, const galerkin_field *field)
{
    const tvi_system *system = field->system;
    const int lanes = field->nodes.lanes;
    set_terms(system, model->term, model->end);
    for (int i = 0; i < lanes; i++) {
        const int node = i < field->points ? i : field->points - 1;
        field->ahead[node * lanes + i] = 1 / field->b[node];
    }
    model->blocks.work = field;
    model->lanes = (lanes_model){
        system->n, lanes, model->lanes.moved, .hessian = model->blocks.hessian, .term = model->term, .end = model->end};
}

bool tvi_galerkin_sweep(const galerkin_blocks *blocks, bool with_hessian)
{
    const galerkin_field *field = blocks->work;
    const jet_tape *tape = with_hessian ? field->system->hessian_values : field->system->field_values;
    double *x = with_hessian ? blocks->hessian : blocks->values;
    if (!jet_sweep_values(tape, x, blocks->lanes)) return false;
    if (field->noise) tvi_galerkin_displace(field, tape, x);
    return true;
}

void tvi_galerkin_model_emit(jet_text *text, const galerkin_model *model)
{
    const galerkin_field *field = model->blocks.work;
    const jet_tape *hessian = field->system->hessian_values;
    const int rows = 2 * model->blocks.n;
    tvi_galerkin_emit_ints(text, "end", rows, model->end);
    jet_text_append(text, "static const lanes_term galerkin_term[] = {");
    for (int k = 0; k < model->end[rows - 1]; k++)
        jet_text_append(text, "{%d, %d}, ", model->term[k].column, model->term[k].slot);
    jet_text_append(text,
                    "{0}};\nenum { GALERKIN_INPUTS = %d, GALERKIN_HESSIAN_KEPT = %d };\n"
                    "#define GALERKIN_HESSIAN_VALUES(x) tvi_hessian_values_%d(x)\n",
                    hessian->inputs, galerkin_rows_kept(hessian), model->blocks.lanes);
}
