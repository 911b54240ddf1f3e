/* field.c - Evaluates the right-hand side of the equations at the nodes of a Galerkin step that is solved by
 * fixed-point iteration: F of a separable system, or (H_p, -H_q) of a Hamiltonian. The unknowns at the nodes are inputs
 * of the field's tape, and their rates follow from its outputs. For a Hamiltonian the tape computes H_q, but the rate
 * of a momentum is -H_q: the factor -1 in unknown_change_per_impulse, by which impulses change the momenta, gives it
 * this sign. The stepper (galerkin.c) calls the functions of tvi_galerkin_form_fixed_point. */
#include "galerkin/field.h"

static void allocate_fixed_point_iteration(galerkin_equations *equations, tvi_arena *arena)
{
    equations->node_value_row_count_read_by_pass = equations->nodes.unknown_count;
    equations->nodes.values =
        tvi_arena_allocate_block(arena, equations->system->field_values, 1, equations->nodes.lane_count, 0);
    equations->tape_block = equations->nodes.values;
    equations->impulse_to_predicted_unknown_or_rate_matrix = equations->node_impulse_to_node_unknown_matrix;
}

/* Returns the tape's output slot that contains the rate of an unknown: F for a separable system; H_p for a
 * coordinate and H_q for a momentum otherwise. */
static int find_rate_slot(const tvi_system *system, int unknown)
{
    const int n = system->n, output = system->form == TVI_SEPARABLE ? unknown : unknown < n ? unknown + n : unknown - n;
    return system->field_values->output_slot[output];
}

static void set_rate_rows_of_fixed_point_iteration(galerkin_equations *equations)
{
    for (int u = 0; u < equations->nodes.unknown_count; u++)
        equations->rate_row_of_unknown[u] = find_rate_slot(equations->system, u);
}

void tvi_galerkin_perturb_tape_outputs_by_roundoff(const galerkin_equations *equations, const jet_tape *tape,
                                                   double *block)
{
    const int lanes = equations->nodes.lane_count;
    for (int i = 0; i < tvi_system_output_count(equations->system); i++)
        for (int lane = 0; lane < lanes; lane++)
            block[tape->output_slot[i] * lanes + lane] += tvi_roundoff_sign_randomly(
                equations->tape_output_roundoff_to_add, equations->tape_output_roundoff_to_add->output_roundoff[i]);
}

static tvi_status predict_fixed_point_unknowns_from_start(galerkin_equations *equations, const tvi_step_origin *origin)
{
    const galerkin_nodes *nodes = &equations->nodes;
    (void)origin;
    for (int u = 0; u < nodes->unknown_count; u++)
        for (int i = 0; i < nodes->lane_count; i++) nodes->values[u * nodes->lane_count + i] = nodes->start_values[u];
    const tvi_status status = galerkin_evaluate_field(equations);
    if (status == TVI_OK) (void)galerkin_move_unknowns_sum_squared_changes(equations);
    return status;
}

static void emit_rate_rows_of_fixed_point_iteration(jet_text *text, const galerkin_equations *equations)
{
    tvi_galerkin_emit_int_array(text, "rate_row_of_unknown", equations->nodes.unknown_count,
                                equations->rate_row_of_unknown);
}

const galerkin_field_form tvi_galerkin_form_fixed_point = {allocate_fixed_point_iteration,
                                                           set_rate_rows_of_fixed_point_iteration,
                                                           predict_fixed_point_unknowns_from_start,
                                                           NULL,
                                                           NULL,
                                                           emit_rate_rows_of_fixed_point_iteration,
                                                           tvi_embedded_galerkin_plain};
