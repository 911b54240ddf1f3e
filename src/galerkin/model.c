/* model.c - see model.h. */
#include "galerkin/model.h"

#include <string.h>

void tvi_galerkin_model_take(galerkin_model *model, tvi_arena *arena, const galerkin_field *field)
{
    const tvi_system *system = field->system;
    const size_t lanes = (size_t)field->nodes.lanes;
    model->values = tvi_arena_block(arena, system->field_values, 1, field->nodes.lanes, 0);
    model->second = tvi_arena_block(arena, system->second_values, 1, field->nodes.lanes, lanes);
    model->lanes.moved = tvi_arena_doubles(arena, 2 * (size_t)system->n * lanes);
    model->term = tvi_arena_take(arena, 2 * (size_t)system->seconds * sizeof *model->term);
    model->end = tvi_arena_take(arena, 2 * (size_t)system->n * sizeof *model->end);
}

/* The rows of the symmetric matrix of second derivatives. */
void tvi_galerkin_model_terms(const tvi_system *system, lanes_term *term, int *end)
{
    const int rows = 2 * system->n;
    for (int k = 0; k < system->seconds; k++) {
        end[system->second[k].row]++;
        if (system->second[k].row != system->second[k].column) end[system->second[k].column]++;
    }
    for (int i = 0, before = 0; i < rows; i++) { /* where the row begins; below, it moves on to the row's end */
        const int count = end[i];
        end[i] = before;
        before += count;
    }
    for (int k = 0; k < system->seconds; k++) {
        const int i = system->second[k].row, j = system->second[k].column;
        const int slot = system->second_values->output[rows + k];
        term[end[i]++] = (lanes_term){j, slot};
        if (i != j) term[end[j]++] = (lanes_term){i, slot};
    }
}

void tvi_galerkin_model_prepare(galerkin_model *model, const galerkin_field *field)
{
    const tvi_system *system = field->system;
    const int lanes = field->nodes.lanes;
    tvi_galerkin_model_terms(system, model->term, model->end);
    model->lanes = (lanes_model){
        system->n, lanes, model->lanes.moved, .second = model->second, .term = model->term, .end = model->end};
}

const double *tvi_galerkin_model_sweep(galerkin_model *model, const galerkin_field *field, bool with_second,
                                       const double *first, const double *last)
{
    const tvi_system *system = field->system;
    const jet_tape *tape = with_second ? system->second_values : system->field_values;
    const int n = system->n, lanes = field->nodes.lanes;
    const size_t bytes = (size_t)n * (size_t)lanes * sizeof(double);
    memcpy(model->values, first, bytes);
    memcpy(model->values + n * lanes, last, bytes);
    double *x = with_second ? model->second : model->values;
    if (with_second) memcpy(x, model->values, (size_t)(tape->inputs * lanes) * sizeof *x);
    if (!jet_sweep_values(tape, x, lanes)) return NULL;
    if (field->noise) tvi_galerkin_displace(field, tape, x);
    return x;
}

bool tvi_galerkin_model_evaluate(galerkin_model *model, const galerkin_field *field, bool with_second,
                                 const double *first, const double *last, double *gradient)
{
    const jet_tape *tape = with_second ? field->system->second_values : field->system->field_values;
    const size_t lanes = (size_t)field->nodes.lanes;
    const double *x = tvi_galerkin_model_sweep(model, field, with_second, first, last);
    if (!x) return false;
    for (int i = 0; i < 2 * field->system->n; i++, gradient += lanes)
        memcpy(gradient, x + (size_t)tape->output[i] * lanes, lanes * sizeof *gradient);
    return true;
}
