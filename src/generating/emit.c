/* emit.c - Writes into generated code the functions that compute a Taylor curve and the gradient of its discrete
 * action, for one system and one degree. The emitted code expands the whole series in one function, and all its
 * tangents in another; every size in it is a constant. The generator of code calls this file through
 * tvi_tapes_of_steps.emit_loops (curve.h). */
#include "generating/curve_stepper.h"
#include "method/method.h"
#include "split.h"

#include <stdlib.h>

extern const char *const tvi_embedded_curve[], *const tvi_embedded_products[], *const tvi_embedded_generated_curve[];

static void emit_text_lines(jet_text *text, const char *const lines[])
{
    for (; *lines; lines++) jet_text_append(text, "%s", *lines);
}

/* Emits a table of the slots of the tape's outputs, and defines `macro_name` as that table. */
static void emit_output_slot_table(jet_text *text, const jet_tape *tape, const char *table_name, const char *macro_name)
{
    jet_text_append(text, "static const int %s[] = {", table_name);
    for (int i = 0; i < tape->output_count; i++) jet_text_append(text, "%d, ", tape->output_slot[i]);
    jet_text_append(text, "};\n#define %s %s\n", macro_name, table_name);
}

static void emit_curve_sizes(jet_text *text, const tvi_system *system, const tvi_options *options, int lanes)
{
    static const char *const form[] = {"TVI_SEPARABLE", "TVI_LAGRANGIAN", "TVI_HAMILTONIAN"};
    /* The number of directions in the smaller last block, or 0. */
    const int rest = lanes > 0 && lanes < 2 * system->n ? 2 * system->n % lanes : 0;
    const int p_degree =
        tvi_find_method(options)->curve.uses_highest_momentum_term ? options->degree : options->degree - 1;
    jet_text_append(text,
                    "enum {\n    CURVE_LANES = %d, CURVE_REST = %d, CURVE_N = %d, CURVE_TOP = tvi_series_top,\n"
                    "    CURVE_INPUTS = %d, CURVE_USES_TIME = %d, CURVE_Q_DEGREE = %d, CURVE_P_DEGREE = %d,\n"
                    "    CURVE_IN_PLACE = %d\n};\n#define CURVE_FORM %s\n",
                    lanes, rest, system->n, system->input_count, system->uses_time, options->degree, p_degree,
                    lanes == 2 * system->n && system->form != TVI_LAGRANGIAN, form[system->form]);
}

/* Emits CURVE_FOLLOWS(slot), which says whether a slot depends on the velocity, the second input of a Lagrangian. */
static void emit_velocity_dependence_macro(jet_text *text, const tvi_system *system)
{
    const jet_tape *tape = system->field_series;
    bool *follows = calloc((size_t)tape->slot_count, sizeof *follows);
    text->is_incomplete |= !follows;
    if (!follows) return;
    for (int i = system->n; i < 2 * system->n; i++) follows[i] = true;
    jet_tape_propagate_slot_dependence(tape, follows);
    jet_text_append(text, "static const bool code_follows[] = {");
    for (int slot = 0; slot < tape->slot_count; slot++) jet_text_append(text, "%d, ", follows[slot]);
    jet_text_append(text, "};\n#define CURVE_FOLLOWS(slot) code_follows[slot]\n");
    free(follows);
}

/* Emits the macros by which the seeds evaluate the field and its tangents at the nodes; code without seeds gets macros
 * that do nothing. Tangents are needed only to find the momenta of given velocities. They are the derivatives of H_p by
 * p, and the tape of the series computes them. */
static void emit_macros_evaluating_field_at_nodes(jet_text *text, const tvi_system *system, const tvi_action *action,
                                                  bool has_seeds)
{
    const jet_tape *field = tvi_select_node_tape(system, action);
    const bool has_velocities = has_seeds && field == system->field_series;
    const int points = action->node_count;
    emit_output_slot_table(text, field, "code_values", "CURVE_VALUES_SLOT");
    if (has_velocities)
        jet_text_append(
            text,
            "JET_GENERATED_TANGENTS_PER_LANE(tvi_series, %d)\n"
            "#define SEEDS_TANGENTS(tape, x, dx, lanes) ((void)(tape), tvi_series_tangents_per_lane_%d(x, dx))\n",
            points, points);
    else jet_text_append(text, "#define SEEDS_TANGENTS(tape, x, dx, lanes) ((void)(tape), (void)(x), (void)(dx))\n");
    if (has_seeds)
        jet_text_append(text, "#define SEEDS_VALUES(tape, x, lanes) ((void)(tape), %s_values_%d(x))\n",
                        has_velocities ? "tvi_series" : "tvi_values", points);
    else jet_text_append(text, "#define SEEDS_VALUES(tape, x, lanes) ((void)(tape), (void)(x), false)\n");
}

/* Emits CURVE_ACTION, the initial values of a tvi_action with these sizes. */
static void emit_action_sizes(jet_text *text, const tvi_action *action)
{
    jet_text_append(
        text,
        "#define CURVE_ACTION {.is_phase_space_action = %d, .omits_highest_order_at_nodes = %d, "
        ".has_gradient_by_v = %d, .has_gradient_by_p = %d, .q_degree = %d, .p_degree = %d, .node_count = %d, "
        ".order_count = %d, .half_node_count = %d}\n",
        action->is_phase_space_action, action->omits_highest_order_at_nodes, action->has_gradient_by_v,
        action->has_gradient_by_p, action->q_degree, action->p_degree, action->node_count, action->order_count,
        action->half_node_count);
}

/* Emits the functions of a curve with Jacobian matrices, by tangents in `lanes` directions; with lanes = 0 it emits
 * products, or no Jacobians. */
static void emit_curve_functions(jet_text *text, const tvi_system *system, const tvi_options *options, int lanes,
                                 bool has_products)
{
    const tvi_curve_definition *definition = &tvi_find_method(options)->curve;
    const tvi_action action = tvi_create_unallocated_action(system, options, 1);
    const bool has_seeds = definition->correct_ends_by_generating_function && options->passes != TVI_PREDICT_ONLY &&
                           seeds_need_no_second_derivatives(&action);
    const bool has_step = lanes > 0 && tvi_has_fast_path_step(system, options);
    if (has_step) jet_text_append(text, "JET_SIDE_BY_SIDE\n");
    emit_curve_sizes(text, system, options, lanes);
    emit_output_slot_table(text, system->field_series, "code_output", "CURVE_SLOT");
    if (system->form == TVI_LAGRANGIAN) emit_velocity_dependence_macro(text, system);
    emit_macros_evaluating_field_at_nodes(text, system, &action, has_seeds);
    emit_action_sizes(text, &action);
    jet_text_append(text,
                    "#define CURVE_HAS_MATRICES %d\n#define CURVE_HAS_PRODUCTS %d\n#define CURVE_HAS_SEED %d\n"
                    "#define CURVE_HAS_STEP %d\n#define CURVE_HAS_STEP_SIZE %d\n",
                    lanes > 0, has_products, has_seeds, has_step, !definition->correct_ends_by_generating_function);
    emit_text_lines(text, tvi_embedded_curve);
    if (has_products) emit_text_lines(text, tvi_embedded_products);
    emit_text_lines(text, tvi_embedded_generated_curve);
}

void tvi_curve_emit_code_without_jacobians(jet_text *text, const tvi_system *system, const tvi_options *options)
{
    emit_curve_functions(text, system, options, 0, false);
}

void tvi_curve_emit_code_with_jacobian_products(jet_text *text, const tvi_system *system, const tvi_options *options)
{
    emit_curve_functions(text, system, options, 0, true);
}

void tvi_curve_emit_code_with_jacobian_matrices(jet_text *text, const tvi_system *system, const tvi_options *options)
{
    emit_curve_functions(text, system, options, tvi_choose_tangent_lane_count(system), false);
}
