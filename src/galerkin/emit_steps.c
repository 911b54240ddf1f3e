/* emit_steps.c - Writes the generated steps of one system: its sizes, lists and the rule of its passes as constants,
 * then the text of generated.h, which includes steps.h, and the structure tvi_generated_steps. galerkin.c calls it for
 * compiled/compile.c. The sweeps of the tapes, which are before this text, are written by ad/emit.c. */
#include "galerkin/galerkin.h"

/* The text of generated.h and of what it includes. The Makefile makes it by ad/embed.awk in
 * build/src/embedded_galerkin.c. */
extern const char *const tvi_embedded_galerkin[];

static void emit_list(jet_text *text, const char *name, int count, const int value[])
{
    jet_text_append(text, "static const int galerkin_%s[] = {", name);
    for (int i = 0; i < count; i++) jet_text_append(text, "%d, ", value[i]);
    jet_text_append(text, "0};\n");
}

static void emit_rule(jet_text *text, const tvi_stopping_rule *rule)
{
    jet_text_append(
        text,
        "#define GALERKIN_RULE {.max_passes = %d, .exact_passes = %d, .correction_goal = %a, .roundoff_level "
        "= %a, .max_trusted_ratio = %a, .stall_ratio = %a, .stall_comparison_lag = "
        "%d, .is_convergence_quadratic = %d}\n",
        rule->max_passes, rule->exact_passes, rule->correction_goal, rule->roundoff_level, rule->max_trusted_ratio,
        rule->stall_ratio, rule->stall_comparison_lag, rule->is_convergence_quadratic);
}

/* Writes the sizes that the form of the equations adds, and the macros by which nodes.h calls the functions that
 * jet_emit_tape has written for the tapes. */
static void emit_hessian(jet_text *text, const galerkin_work *work)
{
    const galerkin_step *step = &work->step;
    const jet_tape *hessian = step->form == GALERKIN_PLAIN ? NULL : step->field.tape[true];
    const hamiltonian_pass *pass = step->hamiltonian;
    jet_text_append(text,
                    "enum { GALERKIN_HESSIAN_SLOTS = %d, GALERKIN_HESSIAN_READ_ONLY_ROWS = %d, GALERKIN_HESSIAN_ROWS = "
                    "%d, GALERKIN_HESSIAN_COLUMNS = %d };\n"
                    "#define GALERKIN_IS_SPLIT " GALERKIN_VALUES_TAPE "_is_split\n"
                    "#define GALERKIN_VALUES_OF_VECTOR(x) VALUES_OF(" GALERKIN_VALUES_TAPE ", x, NODE_VEC)\n"
                    "#define GALERKIN_VALUES(x) " GALERKIN_VALUES_TAPE "_values_%d(x)\n",
                    hessian ? hessian->slot_count : 0, hessian ? hessian->input_count + hessian->constant_count : 0,
                    pass ? pass->rows : 0, pass ? pass->columns : 0, step->nodes.lane_count);
    if (hessian)
        jet_text_append(text, "#define GALERKIN_HESSIAN_VALUES(x) " GALERKIN_HESSIAN_TAPE "_values_%d(x)\n",
                        step->nodes.lane_count);
    else jet_text_append(text, "#define GALERKIN_HESSIAN_VALUES(x) ((void)(x), 0)\n");
}

static void emit_lists(jet_text *text, const galerkin_work *work)
{
    const galerkin_step *step = &work->step;
    const hamiltonian_pass *pass = step->hamiltonian;
    const int unknowns = step->nodes.unknown_count, slots = step->form == GALERKIN_PLAIN ? 0 : unknowns,
              rows = step->form == GALERKIN_PLAIN ? 0 : 2 * work->n,
              elements = rows > 0 ? work->lists.row_end[rows - 1] : 0;
    emit_list(text, "rate_row", unknowns, work->lists.rate_row);
    emit_list(text, "slot", slots, work->lists.slot[false]);
    emit_list(text, "hessian_slot", slots, work->lists.slot[true]);
    emit_list(text, "row_end", rows, work->lists.row_end);
    emit_list(text, "element_column", elements, work->lists.element_column);
    emit_list(text, "element_slot", elements, work->lists.element_slot);
    emit_list(text, "unknown_of_row", pass ? pass->rows : 0, work->lists.unknown_of_row);
    emit_list(text, "index_in_block", pass ? pass->rows * pass->columns : 0, work->lists.index_in_block);
}

void tvi_galerkin_emit_steps(jet_text *text, const galerkin_work *work)
{
    static const char *const form[] = {[GALERKIN_PLAIN] = "GALERKIN_PLAIN",
                                       [GALERKIN_LAGRANGIAN] = "GALERKIN_LAGRANGIAN",
                                       [GALERKIN_HAMILTONIAN] = "GALERKIN_HAMILTONIAN"};
    const galerkin_step *step = &work->step;
    const galerkin_nodes *nodes = &step->nodes;
    const jet_tape *values = step->field.tape[false];
    jet_text_append(
        text,
        "#define GALERKIN_LANES %d\n#define GALERKIN_FORM %s\n"
        "enum { GALERKIN_NODE_COUNT = %d, GALERKIN_N = %d, GALERKIN_UNKNOWNS = %d, GALERKIN_MOVING = %d, "
        "GALERKIN_SUBSYSTEMS = %d, GALERKIN_TAIL_SUBSYSTEMS = %d, GALERKIN_IS_SEPARABLE = %d, GALERKIN_INPUTS = %d, "
        "GALERKIN_VALUE_SLOTS = %d, GALERKIN_READ_ONLY_ROWS = %d };\n",
        nodes->lane_count, form[step->form], nodes->node_count, nodes->n, nodes->unknown_count, nodes->moving_count,
        nodes->subsystems.count, step->tail.subsystems.count, step->is_separable, step->field.input_count,
        values->slot_count, values->input_count + values->constant_count);
    emit_rule(text, &step->rule);
    emit_hessian(text, work);
    emit_lists(text, work);
    for (const char *const *line = tvi_embedded_galerkin; *line; line++) jet_text_append(text, "%s", *line);
    jet_text_append(
        text,
        "static const galerkin_generated_steps tvi_generated_steps = {.make_steps = galerkin_make_generated_steps};\n");
}
