/* emit.c - Writes the Galerkin steps of one system into generated code: the sizes of the system as constants, the
 * kernels of kernel.h for these sizes, and the steps of steps.h. The passes of these steps depend on the form of the
 * field (field.h). The stepper (galerkin.c) calls tvi_galerkin_emit_steps. */
#include "galerkin/field.h"

extern const char *const tvi_embedded_galerkin[];

void tvi_galerkin_emit_int_array(jet_text *text, const char *name, int count, const int value[])
{
    jet_text_append(text, "static const int galerkin_%s[] = {", name);
    for (int i = 0; i < count; i++) jet_text_append(text, "%d, ", value[i]);
    jet_text_append(text, "0};\n");
}

#define FIELD(name) #name, rule->name

static void emit_passes_rule(jet_text *text, const tvi_stopping_rule *rule)
{
    const struct {
        const char *name;
        double value; /* the value of the field `name` of the rule, converted to double */
    } field[] = {{FIELD(max_passes)},
                 {FIELD(exact_passes)},
                 {FIELD(correction_goal)},
                 {FIELD(roundoff_level)},
                 {FIELD(max_trusted_contraction_ratio)},
                 {FIELD(stall_contraction_ratio)},
                 {FIELD(stall_comparison_lag)},
                 {FIELD(is_convergence_quadratic)}};
    jet_text_append(text, "static const tvi_stopping_rule galerkin_rule = {");
    for (size_t i = 0; i < sizeof field / sizeof *field; i++)
        jet_text_append(text, ".%s = %a, ", field[i].name, field[i].value);
    jet_text_append(text, "};\n");
}

static void emit_text_lines(jet_text *text, const char *const *line)
{
    for (; *line; line++) jet_text_append(text, "%s", *line);
}

void tvi_galerkin_emit_steps(jet_text *text, const galerkin_equations *equations, const tvi_stopping_rule *rule)
{
    const galerkin_nodes *nodes = &equations->nodes;
    jet_text_append(text,
                    "#define LANES %d\nenum { GALERKIN_LANES = LANES, GALERKIN_NODE_COUNT = %d, "
                    "GALERKIN_N = %d, GALERKIN_UNKNOWNS = %d, GALERKIN_MOVING_UNKNOWNS = %d, GALERKIN_SUBSYSTEMS = %d, "
                    "GALERKIN_TAIL_SUBSYSTEMS = %d, GALERKIN_IS_SEPARABLE = %d, "
                    "GALERKIN_READ_ONLY_ROWS = %d };\n#define GALERKIN_VALUES(x) tvi_values_values_%d(x)\n",
                    nodes->lane_count, equations->node_count, equations->system->n, nodes->unknown_count,
                    nodes->moving_unknown_count, nodes->subsystems.count, equations->system->tail_subsystems.count,
                    galerkin_is_second_order(equations),
                    galerkin_count_input_and_constant_rows(equations->system->field_values), nodes->lane_count);
    emit_text_lines(text, tvi_embedded_galerkin);
    emit_passes_rule(text, rule);
    equations->form->emit(text, equations);
    emit_text_lines(text, equations->form->text);
    jet_text_append(text, "static const galerkin_generated_code tvi_loops = {galerkin_make_generated_steps};\n");
}
