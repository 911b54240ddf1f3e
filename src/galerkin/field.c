/* field.c - Evaluates the field at the nodes for passes that are a fixed-point iteration: F of a separable system, or
 * (H_p, -H_q) of a Hamiltonian. The unknowns at the nodes are inputs of the field's tape, and their rates follow from
 * its outputs. For a Hamiltonian the tape computes H_q, but the rate of a momentum is -H_q: the factor impulse_scale =
 * -1 of the momenta changes the sign. The stepper (galerkin.c) calls the functions of tvi_galerkin_form_fixed_point. */
#include "galerkin/field.h"

static void allocate_fixed_point_field(galerkin_field *field, tvi_arena *arena)
{
    field->pass_input_row_count = field->nodes.unknown_count;
    field->nodes.values = tvi_arena_allocate_block(arena, field->system->field_values, 1, field->nodes.lane_count, 0);
    field->tape_block = field->nodes.values;
    field->impulse_to_predicted_matrix = field->impulse_matrix;
}

/* Returns the tape's output slot that contains the rate of an unknown: F for a separable system; H_p for a
 * coordinate and H_q for a momentum otherwise. */
static int find_rate_slot(const tvi_system *system, int unknown)
{
    const int n = system->n, output = system->form == TVI_SEPARABLE ? unknown : unknown < n ? unknown + n : unknown - n;
    return system->field_values->output_slot[output];
}

static void set_tables_of_fixed_point_field(galerkin_field *field)
{
    for (int u = 0; u < field->nodes.unknown_count; u++)
        field->rate_row_of_unknown[u] = find_rate_slot(field->system, u);
}

void tvi_galerkin_displace_tape_outputs(const galerkin_field *field, const jet_tape *tape, double *block)
{
    const int lanes = field->nodes.lane_count;
    for (int i = 0; i < tvi_system_output_count(field->system); i++)
        for (int lane = 0; lane < lanes; lane++)
            block[tape->output_slot[i] * lanes + lane] += tvi_roundoff_sign_randomly(
                field->output_displacements, field->output_displacements->output_roundoff[i]);
}

static tvi_status predict_fixed_point_unknowns_from_start(galerkin_field *field, const tvi_step_origin *origin)
{
    const galerkin_nodes *nodes = &field->nodes;
    (void)origin;
    for (int u = 0; u < nodes->unknown_count; u++)
        for (int i = 0; i < nodes->lane_count; i++) nodes->values[u * nodes->lane_count + i] = nodes->start_values[u];
    const tvi_status status = galerkin_evaluate_field(field);
    if (status == TVI_OK) (void)galerkin_move_unknowns_by_rates(field);
    return status;
}

static void emit_fixed_point_field(jet_text *text, const galerkin_field *field)
{
    tvi_galerkin_emit_int_array(text, "rate_row_of_unknown", field->nodes.unknown_count, field->rate_row_of_unknown);
}

const galerkin_field_form tvi_galerkin_form_fixed_point = {
    allocate_fixed_point_field, set_tables_of_fixed_point_field, predict_fixed_point_unknowns_from_start, NULL, NULL,
    emit_fixed_point_field,     tvi_embedded_galerkin_plain};
