/* emit.c - the functions of a curve and of its seeds, for one system and degree, in generated code: the whole series
 * and all tangents are one function each, and what is made of them has every size a constant. */
#include "generating/action.h"
#include "method/method.h"

extern const char *const tvi_embedded_curve[];

static void emit_output(jet_text *text, const jet_tape *tape, const char *name, const char *what)
{
    jet_text_add(text, "static const int %s_%s[] = {", name, what);
    for (int i = 0; i < tape->outputs; i++) jet_text_add(text, "%d, ", tape->output[i]);
    jet_text_add(text, "};\n");
}

static void emit_sizes(jet_text *text, const tvi_system *system, int lanes)
{
    static const char *const name[] = {"separable", "lagrangian", "hamiltonian"};
    static const char *const form_name[] = {"TVI_SEPARABLE", "TVI_LAGRANGIAN", "TVI_HAMILTONIAN"};
    const char *form = name[system->form], *form_of = form_name[system->form];
    jet_text_add(text, "enum { RISE = %d, LANES = %d, N = %d, INPUTS = %d, USES_TIME = %d };\n#define FORM %s\n",
                 system->form == TVI_SEPARABLE ? 2 : 1, lanes, system->n, system->inputs, system->uses_time, form_of);
    jet_text_add(text, "#define ADVANCE tvi_advance_%s\n#define TANGENTS tvi_tangents_%s\n", form, form);
}

static void emit_shape(jet_text *text, const tvi_action *a, const char *name)
{
    jet_text_add(text,
                 "static const tvi_action %s_shape = {.is_hamilton = %d, .truncated = %d, .has_momentum_defect = %d, "
                 ".q_degree = %d, .p_degree = %d, .points = %d, .orders = %d};\n",
                 name, a->is_hamilton, a->truncated, a->has_momentum_defect, a->q_degree, a->p_degree, a->points,
                 a->orders);
}

/* The functions that were defined, of all that there are. */
static void emit_table(jet_text *text, const char *name, bool has_matrices, bool has_seed)
{
    jet_text_add(text, "static const tvi_curve_code %s = {.top = tvi_series_top, .lanes = LANES, ", name);
    static const struct {
        const char *name;
        bool is_of_matrices, is_seed;
    } all[] = {{"expand", false, false},      {"sum", false, false},  {"sizes", false, false},
               {"measure", false, false},     {"tail", false, false}, {"push", true, false},
               {"sum_jacobian", true, false}, {"pull", true, false},  {"seed", false, true},
               {"differentiate", true, false}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if ((has_matrices || !all[i].is_of_matrices) && (has_seed || !all[i].is_seed))
            jet_text_add(text, ".%s = %s_%s, ", all[i].name, name, all[i].name);
    jet_text_add(text, "};\n");
}

static void emit(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name, int lanes)
{
    const tvi_expanded *expanded = &tvi_method_of(options)->curve;
    const int degree = options->degree, p_degree = expanded->has_top_momentum ? degree : degree - 1;
    const bool one_more = expanded->has_top_momentum && system->form == TVI_SEPARABLE;
    const tvi_action shape = tvi_action_shape(system, options, expanded->action, degree, p_degree, degree + one_more);
    const bool has_seed = expanded->close && options->passes != TVI_PREDICT_ONLY && seeds_are_plain(&shape);
    for (const char *const *line = tvi_embedded_curve; *line; line++) jet_text_add(text, "%s", *line);
    emit_sizes(text, system, lanes);
    emit_output(text, system->field_series, name, "output");
    emit_output(text, system->field_values, name, "values");
    jet_text_add(text, "CURVE_EMITTED_EXPAND(%s)\nCURVE_EMITTED_SUMS(%s)\n", name, name);
    if (lanes > 0) jet_text_add(text, "CURVE_EMITTED_MATRICES(%s)\nCURVE_EMITTED_DIFFERENTIATE(%s)\n", name, name);
    if (has_seed) emit_shape(text, &shape, name), jet_text_add(text, "CURVE_EMITTED_SEED(%s)\n", name);
    emit_table(text, name, lanes > 0, has_seed);
}

void tvi_curve_emit_series(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name)
{
    emit(text, system, options, name, 0);
}

void tvi_curve_emit_matrices(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name)
{
    emit(text, system, options, name, tvi_curve_lanes_of(system));
}
