/* emit.c - the functions of a curve and of its seeds, for one system and degree, in generated code: the whole series
 * and all tangents are one function each, and what is made of them has every size a constant. */
#include "algebra/linear_small.h"
#include "generating/action.h"
#include "generating/closure.h"
#include "method/method.h"

extern const char *const tvi_embedded_curve[];

static void emit_output(jet_text *text, const jet_tape *tape, const char *name, const char *what, const char *macro)
{
    jet_text_add(text, "static const int %s_%s[] = {", name, what);
    for (int i = 0; i < tape->outputs; i++) jet_text_add(text, "%d, ", tape->output[i]);
    jet_text_add(text, "};\n#define %s %s_%s\n", macro, name, what);
}

static void emit_sizes(jet_text *text, const tvi_system *system, int lanes)
{
    static const char *const name[] = {"separable", "lagrangian", "hamiltonian"};
    static const char *const form_name[] = {"TVI_SEPARABLE", "TVI_LAGRANGIAN", "TVI_HAMILTONIAN"};
    const char *form = name[system->form], *form_of = form_name[system->form];
    jet_text_add(text,
                 "enum {\n    CURVE_RISE = %d, CURVE_LANES = %d, CURVE_REST = %d, CURVE_N = %d,\n"
                 "    CURVE_TOP = tvi_series_top, CURVE_INPUTS = %d, CURVE_USES_TIME = %d\n};\n#define CURVE_FORM %s\n",
                 system->form == TVI_SEPARABLE ? 2 : 1, lanes, lanes > 0 ? 2 * system->n % lanes : 0, system->n,
                 system->inputs, system->uses_time, form_of);
    jet_text_add(text, "#define CURVE_ADVANCE tvi_advance_%s\n#define CURVE_TANGENTS tvi_tangents_%s\n", form, form);
}

/* The compiler's flags leave alone what stands side by side outside of loops, since most code has vectors of its own;
 * the components and the nodes of a step have none. */
static void emit_slp(jet_text *text)
{
    jet_text_add(text, "#if defined(__GNUC__) && !defined(__clang__)\n"
                       "#pragma GCC optimize(\"tree-slp-vectorize\")\n#endif\n");
}

/* How the seeds have the field at the nodes, of which code without seeds has no sweep. */
static void emit_values(jet_text *text, bool has_seed)
{
    jet_text_add(text, "#define SEEDS_VALUES(tape, x, lanes) ((void)(tape), %s)\n",
                 has_seed ? "tvi_values_values_of(x, lanes)" : "(void)(x), (void)(lanes), false");
}

static void emit_shape(jet_text *text, const tvi_action *a, const char *name)
{
    jet_text_add(text,
                 "static const tvi_action %s_shape = {.is_hamilton = %d, .truncated = %d, .has_momentum_defect = %d, "
                 ".q_degree = %d, .p_degree = %d, .points = %d, .orders = %d, .half = %d};\n",
                 name, a->is_hamilton, a->truncated, a->has_momentum_defect, a->q_degree, a->p_degree, a->points,
                 a->orders, a->half);
}

/* Tangents of a block, and of what is left of the directions. */
static void emit_blocks(jet_text *text, const char *name, int rest)
{
    jet_text_add(text, "CURVE_EMITTED_BLOCK(%s, CURVE_LANES, CURVE_DIFFERENTIATE)\n", name);
    if (rest > 0) jet_text_add(text, "CURVE_EMITTED_BLOCK(%s, CURVE_REST, CURVE_DIFFERENTIATE_REST)\n", name);
    else jet_text_add(text, "#define %s_differentiate_CURVE_REST(curve, first)\n", name);
    jet_text_add(text, "CURVE_EMITTED_DIFFERENTIATE(%s)\n", name);
}

/* The functions that were defined, of all that there are. */
static void emit_table(jet_text *text, const char *name, bool has_matrices, bool has_seed, bool has_step)
{
    jet_text_add(text, "static const tvi_curve_code %s = {.top = tvi_series_top, ", name);
    static const struct {
        const char *name;
        bool is_of_matrices, is_seed, is_step;
    } all[] = {{"expand", false, false, false},  {"sum", false, false, false},         {"sizes", false, false, false},
               {"measure", false, false, false}, {"tail", false, false, false},        {"push", true, false, false},
               {"pull", true, false, false},     {"sum_jacobian", true, false, false}, {"seed", false, true, false},
               {"step", false, false, true},     {"differentiate", true, false, false}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if ((has_matrices || !all[i].is_of_matrices) && (has_seed || !all[i].is_seed) && (has_step || !all[i].is_step))
            jet_text_add(text, ".%s = %s_%s, ", all[i].name, name, all[i].name);
    jet_text_add(text, "};\n");
}

static void emit(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name, int lanes)
{
    const tvi_expanded *expanded = &tvi_method_of(options)->curve;
    const tvi_action shape = tvi_action_of(system, options);
    const bool has_seed = expanded->close && options->passes != TVI_PREDICT_ONLY && seeds_are_plain(&shape);
    const bool has_step = has_seed && lanes > 0 && expanded->close == tvi_close_mean && 2 * system->n <= LINEAR_SMALL;
    if (has_step) emit_slp(text);
    emit_sizes(text, system, lanes);
    emit_output(text, system->field_series, name, "output", "CURVE_SLOT");
    emit_output(text, system->field_values, name, "values", "CURVE_VALUES_SLOT");
    emit_values(text, has_seed);
    for (const char *const *line = tvi_embedded_curve; *line; line++) jet_text_add(text, "%s", *line);
    jet_text_add(text, "CURVE_EMITTED_EXPAND(%s)\nCURVE_EMITTED_SUMS(%s)\n", name, name);
    if (lanes > 0) jet_text_add(text, "CURVE_EMITTED_MATRICES(%s)\n", name);
    if (has_step) jet_text_add(text, "CURVE_EMITTED_EXPAND_ALL(%s)\n", name);
    else if (lanes > 0) emit_blocks(text, name, 2 * system->n % lanes);
    if (has_seed) emit_shape(text, &shape, name), jet_text_add(text, "CURVE_EMITTED_SEED(%s)\n", name);
    if (has_step) jet_text_add(text, "CURVE_EMITTED_STEP(%s)\n", name);
    emit_table(text, name, lanes > 0, has_seed, has_step);
}

void tvi_curve_emit_series(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name)
{
    emit(text, system, options, name, 0);
}

void tvi_curve_emit_matrices(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name)
{
    emit(text, system, options, name, tvi_curve_lanes_of(system));
}
