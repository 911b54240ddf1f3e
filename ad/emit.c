/* emit.c - Writes C code for a tape, which is a recorded function as a straight-line program: the sweeps, functions
 * that compute its values and derivatives (emit.h). src/compiled/ calls it, and so does src/galerkin/,
 * which writes generated steps. */
#include "emit.h"
#include "devices.h"
#include "rule.h"
#include "split.h"

/* ---- Constants found by trials ----------------------------------------------------------------------------------- */

/* [operations] On tapes of up to this size each sum is a run of its own. */
#define EMIT_MAX_SINGLE_SUMS 256 /* found: make performance ONE=compiling */
/* [operations] On tapes of up to this size each operation is a run of its own, if only values are requested, in numbers
 * of lanes that fill whole vectors. */
#define EMIT_MAX_SINGLE_OPERATIONS 768 /* found: make performance ONE=compiling */
/* [operations] The largest tape whose value function is inlined, if the lanes fill several registers. */
#define EMIT_MAX_INLINED 64 /* found: make performance ONE=compiled */
/* [operations] The largest tape whose value function is inlined, if the lanes fill one register. */
#define EMIT_MAX_INLINED_IN_REGISTER 256 /* found: make performance ONE=compiled */

/* A vector register holds from REGISTER_LANES_MIN lanes to REGISTER_LANES_MAX lanes, depending on the instruction set.
 * A multiple of WHOLE_VECTOR_LANES is processed in whole vectors on every machine: if a register holds eight lanes, a
 * shorter vector takes the last four. */
enum { WHOLE_VECTOR_LANES = 4, REGISTER_LANES_MIN = 2, REGISTER_LANES_MAX = 8 };

/* The text of the rules and of emitted.h, which the Makefile makes by ad/embed.awk in build/ad/embedded_rules.c. */
extern const char *const jet_embedded_rules[];

const char *const *jet_embedded_rule_c_source_lines(void) { return jet_embedded_rules; }

void jet_emit_rule_source(jet_text *text)
{
    jet_text_append(text, "#define JET_EMITTED\n#include <math.h>\n#include <stdbool.h>\n#include <stddef.h>\n"
                          "#include <stdint.h>\n");
    for (const char *const *line = jet_embedded_rules; *line; line++) jet_text_append(text, "%s", *line);
}

/* ---- The tape as constants --------------------------------------------------------------------------------------- */

static void emit_int_array(jet_text *text, const char *name_prefix, const char *array_name, int count,
                           const int value[])
{
    jet_text_append(text, "static const int %s_%s[] = {0", name_prefix, array_name);
    for (int i = 0; i < count; i++) jet_text_append(text, i % 16 ? ", %d" : ",\n    %d", value[i]);
    jet_text_append(text, "};\n");
}

static void emit_double_array(jet_text *text, const char *name_prefix, const char *array_name, int count,
                              const double value[])
{
    jet_text_append(text, "static const double %s_%s[] = {0", name_prefix, array_name);
    for (int i = 0; i < count; i++) jet_text_append(text, i % 8 ? ", %a" : ",\n    %a", value[i]);
    jet_text_append(text, "};\n");
}

static void emit_run_initialiser(jet_text *text, const jet_run_of_operations *run)
{
    jet_text_append(text, "    {(jet_op)%d, %d, %d, %d, %d, %d, %a, %d, %d, %d, %d},\n", (int)run->op,
                    run->operation_count, run->z, run->a, run->b, run->w, run->exponent,
                    run->has_nonzero_constant_terms, run->first_constant_term_index, run->term_count,
                    run->first_term_index);
}

typedef struct {
    jet_text *text;
    const jet_tape *tape;
    const jet_emission_request *request;
    int tape_operation_count;
    bool is_each_run_one_operation; /* True if each run is a single operation. */
} tape_emitter;

/* Writes the arrays of the tape as constants. Each array begins with an extra 0, since C has no empty arrays. */
static void emit_tape_arrays(const tape_emitter *emitter)
{
    const jet_tape *tape = emitter->tape;
    const char *name = emitter->request->name_prefix;
    emit_int_array(emitter->text, name, "slot", tape->terms.count, tape->terms.slot);
    emit_int_array(emitter->text, name, "slot_b", tape->terms.count, tape->terms.slot_b);
    emit_int_array(emitter->text, name, "output", tape->output_count, tape->output_slot);
    emit_double_array(emitter->text, name, "coefficient", tape->terms.count, tape->terms.coefficient);
    emit_double_array(emitter->text, name, "constant_terms", tape->linear_operation_count, tape->constant_terms);
    jet_text_append(emitter->text, "static const jet_run_of_operations %s_run[] = {\n", name);
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++)
        emit_run_initialiser(emitter->text, run);
    jet_text_append(emitter->text, "    {0}};\nenum { %s_slots = %d, %s_outputs = %d, %s_is_split = %d };\n", name,
                    tape->slot_count, name, tape->output_count, name, emitter->is_each_run_one_operation);
    jet_text_append(emitter->text,
                    "static const jet_tape %s = {.input_count = %d, .constant_count = %d, .slot_count = %d, .runs = "
                    "(jet_run_of_operations "
                    "*)%s_run,\n"
                    "    .constant_terms = (double *)%s_constant_terms + 1, .terms.slot = (int *)%s_slot + 1,\n"
                    "    .terms.slot_b = (int *)%s_slot_b + 1, .terms.coefficient = (double *)%s_coefficient + 1};\n",
                    name, tape->input_count, tape->constant_count, tape->slot_count, name, name, name, name, name);
}

/* ---- The sweeps -------------------------------------------------------------------------------------------------- */

#define RULE_NAME(op, name) [op] = #name,
static const char *const rule_names[OP_COUNT] = {JET_RULE_LIST(RULE_NAME)};

/* Writes the macro call of one run, such as RULE(T, i, name), for the list T_RUNS (emitted.h). */
static void emit_run_macro_call(const tape_emitter *emitter, const jet_run_of_operations *run)
{
    const char *name = emitter->request->name_prefix;
    const int index = (int)(run - emitter->tape->runs);
    if (run->op == OP_LINEAR)
        jet_text_append(emitter->text, " \\\n    LINEAR(%s, %d, %d)", name, index, run->term_count);
    else if (rule_names[run->op])
        jet_text_append(emitter->text, " \\\n    RULE(%s, %d, %s)", name, index, rule_names[run->op]);
    else
        jet_text_append(emitter->text, " \\\n    PRODUCTS(%s, %d, %d, %d)", name, index, run->op == OP_SQUARES,
                        run->term_count);
}

/* Writes the definition of the macro T_RUNS, with T the name of the tape: one macro call for each run. The macros of
 * emitted.h that define sweeps expand it to the body of the sweep. */
static void emit_T_RUNS_macro(const tape_emitter *emitter)
{
    const jet_run_of_operations *const begin = emitter->tape->runs, *const end = begin + emitter->tape->run_count;
    jet_text_append(emitter->text, "#define %s_RUNS(RULE, PRODUCTS, LINEAR)", emitter->request->name_prefix);
    for (const jet_run_of_operations *run = begin; run < end; run++) emit_run_macro_call(emitter, run);
    jet_text_append(emitter->text, "\n");
}

/* ---- What callers of the sweeps find (tape.h) -------------------------------------------------------------------- */

/* Writes the function NAME_values_LANES, which computes the values for this number of lanes. */
static void emit_value_function(const tape_emitter *emitter, int lanes)
{
    const char *name = emitter->request->name_prefix;
    const bool fits = lanes <= REGISTER_LANES_MAX;
    if (emitter->is_each_run_one_operation && !fits)
        jet_text_append(emitter->text, "JET_VALUES_IN_REGISTERS(%s, %d)\n", name, lanes);
    else
        jet_text_append(emitter->text, "JET_GENERATED_VALUES(%s, %d, %s)\n", name, lanes,
                        emitter->tape_operation_count <= (fits ? EMIT_MAX_INLINED_IN_REGISTER : EMIT_MAX_INLINED)
                            ? "ALWAYS"
                            : "NEVER");
}

/* Writes the functions of the tape that compute values at fixed numbers of lanes, which other generated code also calls
 * directly. Those for one register are written even without a request; an unused one costs nothing. */
static void emit_value_functions(const tape_emitter *emitter)
{
    const int *const lane_counts = emitter->request->value_lane_counts;
    for (int lanes = REGISTER_LANES_MIN; lanes <= REGISTER_LANES_MAX; lanes *= 2) emit_value_function(emitter, lanes);
    for (const int *lanes = lane_counts; *lanes > 0; lanes++) {
        const bool is_register = *lanes == 2 || *lanes == 4 || *lanes == 8;
        if (!is_register && !(lanes > lane_counts && *lanes == lanes[-1])) emit_value_function(emitter, *lanes);
    }
}

static void emit_values_sweep(const tape_emitter *emitter)
{
    const char *name = emitter->request->name_prefix;
    jet_text_append(emitter->text, "static bool %s_values(const jet_tape *tape, double *x, int lanes)\n{\n", name);
    for (const int *lanes = emitter->request->value_lane_counts; *lanes > 0; lanes++)
        jet_text_append(emitter->text, "    if (lanes == %d) return %s_values_%d(x);\n", *lanes, name, *lanes);
    jet_text_append(emitter->text, "    return tape->interpreter_sweeps->values(tape, x, lanes);\n}\n");
}

static void emit_series_sweep(const tape_emitter *emitter)
{
    const char *name = emitter->request->name_prefix;
    jet_text_append(emitter->text,
                    "JET_GENERATED_SERIES(%s)\n"
                    "static bool %s_series(const jet_tape *tape, double *x, int k, int lanes)\n{\n"
                    "    if (lanes != 1) return tape->interpreter_sweeps->series(tape, x, k, lanes);\n"
                    "    return %s_series_of_one_lane(x, k);\n}\n",
                    name, name, name);
}

/* Tells whether the request is for values of whole vectors, and for nothing else. */
static bool requests_only_vector_values(const jet_emission_request *request)
{
    for (const int *lanes = request->value_lane_counts; *lanes > 0; lanes++)
        if (*lanes % WHOLE_VECTOR_LANES != 0) return false;
    return !request->needs_series_sweep;
}

void jet_emit_tape(jet_text *text, const jet_tape *tape, const jet_emission_request *request)
{
    const char *name = request->name_prefix;
    const int operation_count = tape->slot_count - tape->input_count - tape->constant_count;
    const bool is_each_run_one_operation =
        JET_HAS(SPLIT) && operation_count <= EMIT_MAX_SINGLE_OPERATIONS && requests_only_vector_values(request);
    const jet_runs_to_split runs_to_split = is_each_run_one_operation ? JET_SPLIT_ALL
                                            : JET_HAS(SPLIT) && operation_count <= EMIT_MAX_SINGLE_SUMS
                                                ? JET_SPLIT_SUMS
                                                : JET_SPLIT_NONE;
    jet_tape split;
    if (!jet_tape_split_runs(&split, tape, runs_to_split)) {
        text->is_incomplete = true;
        return;
    }
    const tape_emitter emitter = {text, &split, request, operation_count, is_each_run_one_operation};
    emit_tape_arrays(&emitter);
    emit_T_RUNS_macro(&emitter);
    emit_value_functions(&emitter);
    if (request->value_lane_counts[0] > 0) emit_values_sweep(&emitter);
    if (request->needs_series_sweep) emit_series_sweep(&emitter);
    jet_text_append(text, "static const jet_sweeps %s_sweeps = {", name);
    if (request->value_lane_counts[0] > 0) jet_text_append(text, ".values = %s_values, ", name);
    if (request->needs_series_sweep) jet_text_append(text, ".series = %s_series, ", name);
    jet_text_append(text, ".isa = JET_GENERATED_ISA};\n");
    jet_free_split_tape(&split);
}

const jet_sweeps *jet_merge_sweeps(jet_sweeps *merged, const jet_sweeps *interpreted, const jet_sweeps *generated)
{
    *merged = *interpreted;
    if (generated->values) merged->values = generated->values;
    if (generated->series) merged->series = generated->series;
    return merged;
}
