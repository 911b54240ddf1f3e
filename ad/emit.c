/* emit.c - Writes a tape's sweeps as C text (emit.h). */
#include "emit.h"
#include "devices.h"
#include "emit_adjoints.h"
#include "rule.h"
#include "split.h"

#include <stdlib.h>

/* Limits of what is compiled in a second. Tapes with up to APART_MOST operations have their sums apart, and tapes of
 * whole vectors with up to ALONE_MOST operations have all operations apart. Orders are unrolled if operations times
 * orders, and times the tangents beside each order, are at most UNROLLED_MOST. */
enum { APART_MOST = 256, ALONE_MOST = 768, UNROLLED_MOST = 900 };

/* Values of up to INLINED_MOST operations are inlined at any number of lanes, and of up to INLINED_IN_REGISTER at the
 * lanes of one register. Larger ones are a function of their own. */
enum { INLINED_MOST = 64, INLINED_IN_REGISTER = 256 };

/* REGISTER lanes are one vector, of a size that all instruction sets can divide; then the fewest and the most lanes. */
enum { REGISTER = 4, LEAST_REGISTER = 2, MOST_REGISTER = 8 };

extern const char *const jet_embedded_rules[];

const char *const *jet_emit_lines(void) { return jet_embedded_rules; }

void jet_emit_rules(jet_text *text)
{
    jet_text_add(text, "#define JET_WITHOUT %d\n", JET_WITHOUT & JET_DEVICES_OF_TEXT);
    jet_text_add(text, "#define JET_EMITTED\n#include <math.h>\n#include <stdbool.h>\n#include <stddef.h>\n"
                       "#include <stdint.h>\n");
    for (const char *const *line = jet_embedded_rules; *line; line++) jet_text_add(text, "%s", *line);
}

/* ---- The tape as constants --------------------------------------------------------------------------------------- */

static void emit_ints(jet_text *text, const char *name, const char *what, int count, const int value[])
{
    jet_text_add(text, "static const int %s_%s[] = {0", name, what);
    for (int i = 0; i < count; i++) jet_text_add(text, i % 16 ? ", %d" : ",\n    %d", value[i]);
    jet_text_add(text, "};\n");
}

static void emit_doubles(jet_text *text, const char *name, const char *what, int count, const double value[])
{
    jet_text_add(text, "static const double %s_%s[] = {0", name, what);
    for (int i = 0; i < count; i++) jet_text_add(text, i % 8 ? ", %a" : ",\n    %a", value[i]);
    jet_text_add(text, "};\n");
}

static void emit_run(jet_text *text, const jet_run *run)
{
    jet_text_add(text, "    {(jet_op)%d, %d, %d, %d, %d, %d, %a, %d, %d, %d, %d, %d, 0, %d},\n", (int)run->op,
                 run->count, run->z, run->a, run->b, run->w, run->c, run->has_numbers, run->first, run->terms,
                 run->term, run->is_scattered, run->fresh);
}

typedef struct {
    jet_text *text;
    const jet_tape *tape;
    const jet_emission *wanted;
    int operations;
    bool unrolled;    /* the orders are unrolled */
    bool stand_alone; /* the operations stand alone */
} emission;

static bool has_several_roots(const jet_tape *tape)
{
    int roots = 0;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) roots += jet_needs_positive(run);
    return roots > 1;
}

/* Writes the arrays of constants. They begin with a 0, so that none is empty. */
static void emit_constants(const emission *e)
{
    const jet_tape *tape = e->tape;
    const char *name = e->wanted->name;
    emit_ints(e->text, name, "slot", tape->terms, tape->term_slot);
    emit_ints(e->text, name, "operand_b", tape->terms, tape->term_operand_b);
    emit_ints(e->text, name, "output", tape->outputs, tape->output);
    emit_doubles(e->text, name, "coefficient", tape->terms, tape->term_coefficient);
    emit_doubles(e->text, name, "base", tape->rows, tape->base);
    jet_text_add(e->text, "static const jet_run %s_run[] = {\n", name);
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) emit_run(e->text, run);
    jet_text_add(e->text, "    {0}};\nenum { %s_slots = %d, %s_outputs = %d, %s_is_watched = %d, %s_is_split = %d };\n",
                 name, tape->slots, name, tape->outputs, name, has_several_roots(tape), name, e->stand_alone);
    jet_text_add(
        e->text,
        "static const jet_tape %s = {.inputs = %d, .constants = %d, .slots = %d, .run = (jet_run *)%s_run,\n"
        "    .base = (double *)%s_base + 1, .term_slot = (int *)%s_slot + 1, .term_operand_b = (int *)%s_operand_b + "
        "1, .term_coefficient = (double *)%s_coefficient + 1};\n",
        name, tape->inputs, tape->constants, tape->slots, name, name, name, name, name);
}

/* ---- The sweeps -------------------------------------------------------------------------------------------------- */

#define RULE_NAME(op, name) [op] = #name,
static const char *const rule_name[OP_COUNT] = {JET_RULE_LIST(RULE_NAME)};

/* Writes a line of the list in emitted.h. */
static void emit_line(const emission *e, const jet_run *run)
{
    const char *name = e->wanted->name;
    const int index = (int)(run - e->tape->run);
    if (run->op == OP_LINEAR) jet_text_add(e->text, " \\\n    LINEAR(%s, %d, %d)", name, index, run->terms);
    else if (run->is_scattered)
        jet_text_add(e->text, " \\\n    SCATTERED(%s, %d, %d, %d)", name, index, run->op == OP_SQUARES, run->terms);
    else if (rule_name[run->op]) jet_text_add(e->text, " \\\n    RULE(%s, %d, %s)", name, index, rule_name[run->op]);
    else jet_text_add(e->text, " \\\n    PRODUCTS(%s, %d, %d, %d)", name, index, run->op == OP_SQUARES, run->terms);
}

static bool begins_angles(const jet_tape *tape, const jet_run *run)
{
    return run >= tape->run && run->op == OP_SIN && run->together > 1;
}

/* Tells whether two runs are single products with the same second factor and adjacent first factors, neither of which
 * is the other's result. */
static bool are_paired(const jet_tape *tape, const jet_run *run, const jet_run *next)
{
    const int a = tape->term_slot[run->term], b = tape->term_slot[next->term];
    return run->op == OP_PRODUCTS && next->op == OP_PRODUCTS && run->count * run->terms == 1 &&
           next->count * next->terms == 1 && abs(a - b) == 1 && b != run->z &&
           tape->term_operand_b[run->term] == tape->term_operand_b[next->term] &&
           tape->term_coefficient[run->term] == tape->term_coefficient[next->term];
}

/* Tells whether two paired products begin here. In a longer series, every two make a pair. */
static bool begins_paired(const jet_tape *tape, const jet_run *run)
{
    return JET_HAS(PAIRS) && run >= tape->run && run + 1 < tape->run + tape->runs && are_paired(tape, run, run + 1) &&
           !begins_paired(tape, run - 1);
}

/* Writes the line of a run. The first of two runs with the same angles, or of paired products, stands for both. */
static void emit_lines(const emission *e, const jet_run *run)
{
    const int index = (int)(run - e->tape->run);
    if (begins_angles(e->tape, run - 1) || begins_paired(e->tape, run - 1)) return;
    const char *both = begins_angles(e->tape, run) ? "ANGLES" : begins_paired(e->tape, run) ? "PAIRED" : NULL;
    if (both) jet_text_add(e->text, " \\\n    %s(%s, %d, %d)", both, e->wanted->name, index, index + 1);
    else emit_line(e, run);
}

static void emit_line_back(const emission *e, const jet_run *run)
{
    const jet_run *first = jet_is_sum(run) ? jet_first_sum(e->tape, run) : NULL;
    if (!first) emit_lines(e, run);
    else if (jet_end_of_sums(e->tape, first) == run + 1)
        jet_text_add(e->text, " \\\n    SUMS(%s, %d)", e->wanted->name, (int)(first - e->tape->run));
}

/* ------------------------------------------------------------------------------------------------------------------ */

static void emit_lists(const emission *e)
{
    const jet_run *const begin = e->tape->run, *const end = begin + e->tape->runs;
    jet_text_add(e->text, "#define %s_RUNS(RULE, ANGLES, PRODUCTS, SCATTERED, PAIRED, LINEAR)", e->wanted->name);
    for (const jet_run *run = begin; run < end; run++) emit_lines(e, run);
    jet_text_add(e->text, "\n#define %s_RUNS_BACK(RULE, ANGLES, PRODUCTS, SCATTERED, PAIRED, LINEAR, SUMS)",
                 e->wanted->name);
    for (const jet_run *run = end; run-- > begin && e->wanted->has_adjoints;) emit_line_back(e, run);
    jet_text_add(e->text, "\n");
}

/* ---- What callers of the sweeps find (tape.h) -------------------------------------------------------------------- */

/* Writes a function that returns the sweep of order k. k is a constant in each case if orders are unrolled; `behind`
 * follows k. */
static void emit_orders(const emission *e, const char *sweep, const char *blocks, const char *behind)
{
    const char *name = e->wanted->name;
    if (e->unrolled) jet_text_add(e->text, "    switch (k) {\n");
    for (int k = 0; k <= e->wanted->top && e->unrolled; k++)
        jet_text_add(e->text, "    case %d: return %s_%s(%s, %d%s);\n", k, name, sweep, blocks, k, behind);
    if (e->unrolled) jet_text_add(e->text, "    }\n");
    jet_text_add(e->text, "    return %s_%s(%s, k%s);\n}\n", name, sweep, blocks, behind);
}

/* Writes NAME_ORDERS(ORDER), which calls ORDER for all orders, with constants if they are unrolled. */
static void emit_all_orders(const emission *e)
{
    const char *name = e->wanted->name;
    const int top = e->wanted->top;
    jet_text_add(e->text, "enum { %s_top = %d };\n#define %s_ORDERS(ORDER) ORDER(0)", name, top, name);
    for (int k = 1; k <= top && e->unrolled; k++) jet_text_add(e->text, " ORDER(%d)", k);
    if (!e->unrolled) jet_text_add(e->text, " for (int k = 1; k <= %s_top; k++) { ORDER(k) }", name);
    jet_text_add(e->text, "\n");
}

/* Writes NAME_values_LANES. */
static void emit_values_at(const emission *e, int lanes)
{
    const char *name = e->wanted->name;
    const bool fits = lanes <= MOST_REGISTER;
    if (e->stand_alone && !fits) jet_text_add(e->text, "JET_GENERATED_VALUES_IN_REGISTERS(%s, %d)\n", name, lanes);
    else
        jet_text_add(e->text, "JET_GENERATED_VALUES(%s, %d, %s)\n", name, lanes,
                     e->operations <= (fits ? INLINED_IN_REGISTER : INLINED_MOST) ? "ALWAYS" : "NEVER");
}

/* Writes the value functions that others inline, or call if they are large. Value functions for one register are always
 * written; unused ones cost nothing. */
static void emit_inner(const emission *e)
{
    const char *name = e->wanted->name;
    const int *const wanted = e->wanted->lanes;
    for (int lanes = LEAST_REGISTER; lanes <= MOST_REGISTER; lanes *= 2) emit_values_at(e, lanes);
    for (const int *lanes = wanted; *lanes > 0; lanes++) {
        const bool is_register = *lanes == 2 || *lanes == 4 || *lanes == 8;
        if (!is_register && !(lanes > wanted && *lanes == lanes[-1])) emit_values_at(e, *lanes);
    }
    if (wanted[0] == 1)
        jet_text_add(e->text, "JET_GENERATED_SERIES(%s)\nJET_GENERATED_TANGENTS(%s)\nJET_GENERATED_ADJOINTS(%s)\n",
                     name, name, name);
}

static void emit_values(const emission *e)
{
    const char *name = e->wanted->name;
    jet_text_add(e->text, "static bool %s_values(const jet_tape *tape, double *x, int lanes)\n{\n", name);
    for (const int *lanes = e->wanted->lanes; *lanes > 0; lanes++)
        jet_text_add(e->text, "    if (lanes == %d) return %s_values_%d(x);\n", *lanes, name, *lanes);
    jet_text_add(e->text, "    return tape->interpreted->values(tape, x, lanes);\n}\n");
}

static void emit_series(const emission *e)
{
    jet_text_add(e->text,
                 "static bool %s_series(const jet_tape *tape, double *x, int k, int lanes)\n{\n"
                 "    if (lanes != 1) return tape->interpreted->series(tape, x, k, lanes);\n",
                 e->wanted->name);
    emit_orders(e, "series_of", "x", "");
}

/* Writes a function of tangents for each number of lanes. */
static void emit_tangents(const emission *e)
{
    const char *name = e->wanted->name;
    for (const int *lanes = e->wanted->directions; *lanes > 0; lanes++) {
        jet_text_add(e->text,
                     "static bool %s_tangents_%d(const double *x, double *dx, int k)\n{\n"
                     "    enum { lanes = %d };\n",
                     name, *lanes, *lanes);
        emit_orders(e, "tangents_of", "x, dx", ", lanes");
    }
    jet_text_add(e->text,
                 "static void %s_tangents(const jet_tape *tape, const double *x, double *dx, int k, int lanes)\n{\n",
                 name);
    for (const int *lanes = e->wanted->directions; *lanes > 0; lanes++)
        jet_text_add(e->text, "    if (lanes == %d) %s_tangents_%d(x, dx, k);\n    else\n", *lanes, name, *lanes);
    jet_text_add(e->text, "    tape->interpreted->tangents(tape, x, dx, k, lanes);\n}\n");
}

static void emit_adjoint_sweep(const emission *e)
{
    const char *name = e->wanted->name;
    jet_text_add(e->text,
                 "static void %s_adjoints(const jet_tape *tape, const double *x, double *bar, int k, int top)\n{\n"
                 "    (void)tape;\n    %s_adjoints_of(x, bar, k, top);\n}\n",
                 name, name);
}

/* Tells whether values of whole vectors are wanted, and nothing else. */
static bool is_of_registers(const jet_emission *wanted)
{
    for (const int *lanes = wanted->lanes; *lanes > 0; lanes++)
        if (*lanes % REGISTER != 0) return false;
    return !wanted->has_series && !wanted->has_adjoints && wanted->directions[0] == 0;
}

void jet_emit_tape(jet_text *text, const jet_tape *tape, const jet_emission *wanted)
{
    const char *name = wanted->name;
    const int operations = tape->slots - tape->inputs - tape->constants;
    const bool stand_alone = JET_HAS(SPLIT) && operations <= ALONE_MOST && is_of_registers(wanted);
    const jet_split which = stand_alone && wanted->is_force              ? JET_SPLIT_PAIRS
                            : stand_alone                                ? JET_SPLIT_ALL
                            : JET_HAS(SPLIT) && operations <= APART_MOST ? JET_SPLIT_SUMS
                                                                         : JET_SPLIT_NONE;
    jet_tape split;
    if (!jet_tape_split(&split, tape, which)) {
        text->failed = true;
        return;
    }
    const bool unrolled =
        JET_HAS(UNROLL) && operations * (1 + wanted->tangent_vectors) * (wanted->top + 1) <= UNROLLED_MOST;
    const emission e = {text, &split, wanted, operations, unrolled, stand_alone};
    if (wanted->has_adjoints) jet_emit_adjoints(text, &split, name);
    emit_constants(&e);
    emit_lists(&e);
    emit_inner(&e);
    emit_all_orders(&e);
    if (wanted->lanes[0] > 0) emit_values(&e);
    if (wanted->has_series) emit_series(&e);
    if (wanted->directions[0] > 0) emit_tangents(&e);
    if (wanted->has_adjoints) emit_adjoint_sweep(&e);
    jet_text_add(text, "static const jet_sweeps %s_sweeps = {", name);
    if (wanted->lanes[0] > 0) jet_text_add(text, ".values = %s_values, ", name);
    if (wanted->has_series) jet_text_add(text, ".series = %s_series, ", name);
    if (wanted->directions[0] > 0) jet_text_add(text, ".tangents = %s_tangents, ", name);
    if (wanted->has_adjoints) jet_text_add(text, ".adjoints = %s_adjoints, ", name);
    jet_text_add(text, ".isa = JET_GENERATED_ISA};\n");
    jet_tape_free_split(&split);
}

const jet_sweeps *jet_sweeps_merge(jet_sweeps *merged, const jet_sweeps *interpreted, const jet_sweeps *code)
{
    *merged = *interpreted;
    if (code->values) merged->values = code->values;
    if (code->series) merged->series = code->series;
    if (code->tangents) merged->tangents = code->tangents;
    if (code->adjoints) merged->adjoints = code->adjoints;
    return merged;
}
