/* emit.c - the functions of a curve and of its seeds, for one system and degree, in generated code: the whole series
 * and all tangents are one function each, and what is made of them has every size a constant. */
#include "algebra/linear_small.h"
#include "generating/action.h"
#include "generating/closure.h"
#include "method/method.h"
#include "split.h"

#include <stdlib.h>

extern const char *const tvi_embedded_curve[], *const tvi_embedded_products[];

static void emit_text(jet_text *text, const char *const lines[])
{
    for (; *lines; lines++) jet_text_add(text, "%s", *lines);
}

static void emit_output(jet_text *text, const jet_tape *tape, const char *name, const char *what, const char *macro)
{
    jet_text_add(text, "static const int %s_%s[] = {", name, what);
    for (int i = 0; i < tape->outputs; i++) jet_text_add(text, "%d, ", tape->output[i]);
    jet_text_add(text, "};\n#define %s %s_%s\n", macro, name, what);
}

/* Directions that are left of blocks of so many lanes; 0: none, or there is one block. */
static int rest_of(const tvi_system *system, int lanes)
{
    return lanes > 0 && lanes < 2 * system->n ? 2 * system->n % lanes : 0;
}

static void emit_sizes(jet_text *text, const tvi_system *system, const tvi_options *options, int lanes)
{
    static const char *const name[] = {"separable", "lagrangian", "hamiltonian"};
    static const char *const form_name[] = {"TVI_SEPARABLE", "TVI_LAGRANGIAN", "TVI_HAMILTONIAN"};
    const int p_degree = tvi_method_of(options)->curve.has_top_momentum ? options->degree : options->degree - 1;
    const char *form = name[system->form], *form_of = form_name[system->form];
    jet_text_add(text,
                 "enum {\n    CURVE_RISE = %d, CURVE_LANES = %d, CURVE_REST = %d, CURVE_N = %d,\n"
                 "    CURVE_TOP = tvi_series_top, CURVE_INPUTS = %d, CURVE_USES_TIME = %d,\n"
                 "    CURVE_Q_DEGREE = %d, CURVE_P_DEGREE = %d, CURVE_IN_PLACE = %d\n};\n#define CURVE_FORM %s\n",
                 system->form == TVI_SEPARABLE ? 2 : 1, lanes, rest_of(system, lanes), system->n, system->inputs,
                 system->uses_time, options->degree, p_degree, lanes == 2 * system->n && system->form != TVI_LAGRANGIAN,
                 form_of);
    jet_text_add(text, "#define CURVE_ADVANCE tvi_advance_%s\n#define CURVE_TANGENTS tvi_tangents_%s\n", form, form);
    const char *recurrence = system->form == TVI_LAGRANGIAN ? "LAGRANGIAN" : "EXPLICIT";
    jet_text_add(text, "#define CURVE_EXPAND CURVE_EXPAND_%s\n#define CURVE_DIFFERENTIATE CURVE_DIFFERENTIATE_%s\n",
                 recurrence, recurrence);
}

/* The compiler's flags leave alone what stands side by side outside of loops, since most code has vectors of its own;
 * the components and the nodes of a step have none. */
static void emit_slp(jet_text *text)
{
    jet_text_add(text, "#if defined(__GNUC__) && !defined(__clang__)\n"
                       "#pragma GCC optimize(\"tree-slp-vectorize\")\n#endif\n");
}

/* CURVE_FOLLOWS(slot): whether the slot depends on the velocity, the second input of a Lagrangian. */
static void emit_followers(jet_text *text, const tvi_system *system, const char *name)
{
    const jet_tape *tape = system->field_series;
    bool *follows = calloc((size_t)tape->slots, sizeof *follows);
    text->failed |= !follows;
    if (!follows) return;
    for (int i = system->n; i < 2 * system->n; i++) follows[i] = true;
    jet_tape_follow(tape, follows);
    jet_text_add(text, "static const bool %s_follows[] = {", name);
    for (int slot = 0; slot < tape->slots; slot++) jet_text_add(text, "%d, ", follows[slot]);
    jet_text_add(text, "};\n#define CURVE_FOLLOWS(slot) %s_follows[slot]\n", name);
    free(follows);
}

/* How the seeds have the field at the nodes, of which code without seeds has no sweep; tangents are those of velocities
 * by momenta, by the series' tape. */
static void emit_field(jet_text *text, const char *name, const tvi_system *system, const tvi_action *a, bool has_seed)
{
    const jet_tape *field = tvi_action_field(system, a->is_hamilton ? TVI_ACTION_HAMILTON : TVI_ACTION_LAGRANGE);
    const bool has_velocities = has_seed && field == system->field_series;
    const int points = a->points;
    emit_output(text, field, name, "values", "CURVE_VALUES_SLOT");
    if (has_velocities)
        jet_text_add(
            text,
            "JET_EMITTED_TANGENTS_IN_LANES(tvi_series, %d)\n"
            "#define SEEDS_TANGENTS(tape, x, dx, lanes) ((void)(tape), tvi_series_tangents_in_lanes_%d(x, dx))\n",
            points, points);
    else jet_text_add(text, "#define SEEDS_TANGENTS(tape, x, dx, lanes) ((void)(tape), (void)(x), (void)(dx))\n");
    if (has_seed)
        jet_text_add(text, "#define SEEDS_VALUES(tape, x, lanes) ((void)(tape), %s_values_%d(x))\n",
                     has_velocities ? "tvi_series" : "tvi_values", points);
    else jet_text_add(text, "#define SEEDS_VALUES(tape, x, lanes) ((void)(tape), (void)(x), false)\n");
}

static void emit_shape(jet_text *text, const tvi_action *a, const char *name)
{
    jet_text_add(
        text,
        "static const tvi_action %s_shape = {.is_hamilton = %d, .truncated = %d, .has_velocity_defect = %d, "
        ".has_momentum_defect = %d, .q_degree = %d, .p_degree = %d, .points = %d, .orders = %d, .half = %d};\n",
        name, a->is_hamilton, a->truncated, a->has_velocity_defect, a->has_momentum_defect, a->q_degree, a->p_degree,
        a->points, a->orders, a->half);
}

/* Tangents of a block, and of what is left of the directions. */
static void emit_blocks(jet_text *text, const char *name, int rest)
{
    jet_text_add(text, "CURVE_EMITTED_BLOCK(%s, CURVE_LANES)\n", name);
    if (rest > 0) jet_text_add(text, "CURVE_EMITTED_BLOCK(%s, CURVE_REST)\n", name);
    else jet_text_add(text, "#define %s_differentiate_CURVE_REST(curve, first)\n", name);
    jet_text_add(text, "CURVE_EMITTED_DIFFERENTIATE(%s)\n", name);
}

/* The functions that were defined, of all that there are. */
enum { OF_ALL = 1, OF_MATRICES = 2, OF_PRODUCTS = 4, OF_SEEDS = 8, OF_STEPS = 16, OF_REACH = 32 };
static void emit_table(jet_text *text, const char *name, int has)
{
    jet_text_add(text, "static const tvi_curve_code %s = {.top = tvi_series_top, ", name);
    static const struct {
        const char *name;
        int of;
    } all[] = {{"expand", OF_ALL},    {"sum", OF_ALL},      {"sizes", OF_ALL},
               {"measure", OF_ALL},   {"tail", OF_ALL},     {"push", OF_MATRICES | OF_PRODUCTS},
               {"pull", OF_MATRICES}, {"aim", OF_PRODUCTS}, {"sum_jacobian", OF_MATRICES},
               {"reach", OF_REACH},   {"end_at", OF_REACH}, {"change", OF_REACH},
               {"seed", OF_SEEDS},    {"step", OF_STEPS},   {"differentiate", OF_MATRICES}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (has & all[i].of) jet_text_add(text, ".%s = %s_%s, ", all[i].name, name, all[i].name);
    if (has & OF_PRODUCTS) jet_text_add(text, ".solver = &%s_solver, ", name);
    jet_text_add(text, "};\n");
}

/* By tangents in so many directions, or by products. */
static void emit(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name, int lanes,
                 bool has_products)
{
    const tvi_expanded *expanded = &tvi_method_of(options)->curve;
    const tvi_action shape = tvi_action_of(system, options);
    const bool has_seed = expanded->close && options->passes != TVI_PREDICT_ONLY && seeds_are_plain(&shape);
    const bool has_step = has_seed && lanes > 0 && expanded->close == tvi_close_mean && 2 * system->n <= LINEAR_SMALL;
    const bool has_reach = !expanded->close;
    if (has_step) emit_slp(text);
    emit_sizes(text, system, options, lanes);
    emit_output(text, system->field_series, name, "output", "CURVE_SLOT");
    if (system->form == TVI_LAGRANGIAN) emit_followers(text, system, name);
    emit_field(text, name, system, &shape, has_seed);
    emit_text(text, tvi_embedded_curve);
    jet_text_add(text, "CURVE_EMITTED_EXPAND(%s)\nCURVE_EMITTED_SUMS(%s)\n", name, name);
    if (lanes > 0) jet_text_add(text, "CURVE_EMITTED_MATRICES(%s)\n", name);
    if (has_products) emit_text(text, tvi_embedded_products), jet_text_add(text, "CURVE_EMITTED_PRODUCTS(%s)\n", name);
    if (has_step) jet_text_add(text, "CURVE_EMITTED_EXPAND_ALL(%s)\n", name);
    else if (lanes > 0) emit_blocks(text, name, rest_of(system, lanes));
    if (has_seed) emit_shape(text, &shape, name), jet_text_add(text, "CURVE_EMITTED_SEED(%s)\n", name);
    if (has_step) jet_text_add(text, "CURVE_EMITTED_STEP(%s)\n", name);
    if (has_reach) jet_text_add(text, "CURVE_EMITTED_REACH(%s)\n", name);
    emit_table(text, name,
               OF_ALL | (lanes > 0 ? OF_MATRICES : 0) | (has_products ? OF_PRODUCTS : 0) | (has_seed ? OF_SEEDS : 0) |
                   (has_step ? OF_STEPS : 0) | (has_reach ? OF_REACH : 0));
}

void tvi_curve_emit_series(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name)
{
    emit(text, system, options, name, 0, false);
}

void tvi_curve_emit_products(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name)
{
    emit(text, system, options, name, 0, true);
}

void tvi_curve_emit_matrices(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name)
{
    emit(text, system, options, name, tvi_curve_lanes_of(system), false);
}
