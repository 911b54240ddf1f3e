/* emit.c - Writes C code for a tape, which is a recorded function as a straight-line program: the sweeps, functions
 * that compute its values and derivatives (emit.h). src/compiled/ calls it, and so do the files of the methods that
 * write generated steps. */
#include "emit.h"
#include "devices.h"
#include "rule.h"
#include "split.h"

/* A vector register holds from REGISTER_LANES_MIN lanes to REGISTER_LANES_MAX lanes, depending on the instruction set.
 * A multiple of WHOLE_VECTOR_LANES is processed in whole vectors on every machine: if a register holds eight lanes, a
 * shorter vector takes the last four. */
enum { WHOLE_VECTOR_LANES = 4, REGISTER_LANES_MIN = 2, REGISTER_LANES_MAX = 8 };

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
    emit_int_array(emitter->text, name, "slot", tape->term_count, tape->term_slot);
    emit_int_array(emitter->text, name, "slot_b", tape->term_count, tape->term_slot_b);
    emit_int_array(emitter->text, name, "output", tape->output_count, tape->output_slot);
    emit_double_array(emitter->text, name, "coefficient", tape->term_count, tape->term_coefficient);
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
                    "    .constant_terms = (double *)%s_constant_terms + 1, .term_slot = (int *)%s_slot + 1,\n"
                    "    .term_slot_b = (int *)%s_slot_b + 1, .term_coefficient = (double *)%s_coefficient + 1};\n",
                    name, tape->input_count, tape->constant_count, tape->slot_count, name, name, name, name, name);
}

/* ---- Adjoints of sums -------------------------------------------------------------------------------------------- */

/* Tells whether a run is a single sum. All LINEAR runs are single sums if the tape was split by JET_SPLIT_SUMS or
 * JET_SPLIT_ALL. */
static bool is_single_sum(const jet_run_of_operations *run)
{
    return run->op == OP_LINEAR && run->operation_count == 1;
}

/* Tells whether a term of the sum reads `slot` or a later slot. */
static bool sum_reads_slot_at_or_after(const jet_tape *tape, const jet_run_of_operations *run, int slot)
{
    for (int term = run->first_term_index; term < run->first_term_index + run->term_count; term++)
        if (tape->term_slot[term] >= slot) return true;
    return false;
}

/* Returns the first sum in the sequence of adjacent sums that contains one_of_the_sums. No sum of a sequence reads
 * another. */
static const jet_run_of_operations *find_start_of_adjacent_sums(const jet_tape *tape,
                                                                const jet_run_of_operations *one_of_the_sums)
{
    const jet_run_of_operations *first = one_of_the_sums;
    while (first > tape->runs && is_single_sum(first - 1)) first--;
    for (const jet_run_of_operations *next = first; next <= one_of_the_sums; next++)
        if (sum_reads_slot_at_or_after(tape, next, first->z)) first = next;
    return first;
}

/* Returns the end of the sequence of adjacent sums that begins with `first`. */
static const jet_run_of_operations *find_end_of_adjacent_sums(const jet_tape *tape, const jet_run_of_operations *first)
{
    const jet_run_of_operations *const end = tape->runs + tape->run_count, *next = first;
    while (next < end && is_single_sum(next) && find_start_of_adjacent_sums(tape, next) == first) next++;
    return next;
}

/* Writes one statement, which adds the contributions of the sums `first`, ..., end - 1 to the adjoint of a slot. */
static void emit_adjoint_contributions_of_sums(jet_text *text, const jet_tape *tape, const jet_run_of_operations *first,
                                               const jet_run_of_operations *end, int slot)
{
    bool has_any = false;
    for (const jet_run_of_operations *run = first; run < end; run++)
        for (int term = run->first_term_index; term < run->first_term_index + run->term_count; term++) {
            if (tape->term_slot[term] != slot) continue;
            if (!has_any) jet_text_append(text, "    bar[%d] = bar[%d]", slot, slot);
            jet_text_append(text, " + %a * bar[%d]", tape->term_coefficient[term], run->z);
            has_any = true;
        }
    if (has_any) jet_text_append(text, ";\n");
}

/* Writes the functions NAME_sums_back_i(bar), which compute the adjoints of the adjacent sums from run i on. The
 * contributions of these sums to an operand are summed in one statement. */
static void emit_adjoints_of_sums(const tape_emitter *emitter)
{
    const jet_tape *tape = emitter->tape;
    for (const jet_run_of_operations *first = tape->runs; first < tape->runs + tape->run_count; first++) {
        if (!is_single_sum(first) || find_start_of_adjacent_sums(tape, first) != first) continue;
        jet_text_append(emitter->text, "JET_INLINE void %s_sums_back_%d(double *bar)\n{\n",
                        emitter->request->name_prefix, (int)(first - tape->runs));
        for (int slot = 0; slot < first->z; slot++)
            emit_adjoint_contributions_of_sums(emitter->text, tape, first, find_end_of_adjacent_sums(tape, first),
                                               slot);
        jet_text_append(emitter->text, "}\n");
    }
}

/* ---- The sweeps -------------------------------------------------------------------------------------------------- */

#define RULE_NAME(op, name) [op] = #name,
static const char *const rule_names[OP_COUNT] = {JET_RULE_LIST(RULE_NAME)};

/* Writes the macro call of one run, such as RULE(T, i, name), for the lists T_RUNS and T_RUNS_BACK (emitted.h). */
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

/* Writes the macro call of one run for the list T_RUNS_BACK. Adjacent sums have one call SUMS(T, i) together. */
static void emit_run_macro_call_for_adjoint_sweep(const tape_emitter *emitter, const jet_run_of_operations *run)
{
    const jet_run_of_operations *first = is_single_sum(run) ? find_start_of_adjacent_sums(emitter->tape, run) : NULL;
    if (!first) emit_run_macro_call(emitter, run);
    else if (find_end_of_adjacent_sums(emitter->tape, first) == run + 1)
        jet_text_append(emitter->text, " \\\n    SUMS(%s, %d)", emitter->request->name_prefix,
                        (int)(first - emitter->tape->runs));
}

/* ------------------------------------------------------------------------------------------------------------------ */

/* Writes the macros T_RUNS and T_RUNS_BACK (emitted.h). */
static void emit_macros_that_list_all_runs(const tape_emitter *emitter)
{
    const jet_run_of_operations *const begin = emitter->tape->runs, *const end = begin + emitter->tape->run_count;
    jet_text_append(emitter->text, "#define %s_RUNS(RULE, PRODUCTS, LINEAR)", emitter->request->name_prefix);
    for (const jet_run_of_operations *run = begin; run < end; run++) emit_run_macro_call(emitter, run);
    jet_text_append(emitter->text, "\n#define %s_RUNS_BACK(RULE, PRODUCTS, LINEAR, SUMS)",
                    emitter->request->name_prefix);
    for (const jet_run_of_operations *run = end; run-- > begin && emitter->request->needs_adjoint_sweep;)
        emit_run_macro_call_for_adjoint_sweep(emitter, run);
    jet_text_append(emitter->text, "\n");
}

/* ---- What callers of the sweeps find (tape.h) -------------------------------------------------------------------- */

/* Writes the function NAME_values_LANES, which computes the values for this number of lanes. */
static void emit_value_function(const tape_emitter *emitter, int lanes)
{
    const char *name = emitter->request->name_prefix;
    const bool fits = lanes <= REGISTER_LANES_MAX;
    if (emitter->is_each_run_one_operation && !fits)
        jet_text_append(emitter->text, "JET_GENERATED_VALUES_IN_REGISTERS(%s, %d)\n", name, lanes);
    else
        jet_text_append(emitter->text, "JET_GENERATED_VALUES(%s, %d, %s)\n", name, lanes,
                        emitter->tape_operation_count <= (fits ? EMIT_MAX_INLINED_IN_REGISTER : EMIT_MAX_INLINED)
                            ? "ALWAYS"
                            : "NEVER");
}

/* Writes the functions of the tape that other generated code calls directly, and not through the table of sweeps: for
 * values at fixed numbers of lanes, and for series with their tangents and adjoints. The value functions for one
 * register are written even without a request; an unused one costs nothing. */
static void emit_functions_for_other_generated_code(const tape_emitter *emitter)
{
    const char *name = emitter->request->name_prefix;
    const int *const lane_counts = emitter->request->value_lane_counts;
    for (int lanes = REGISTER_LANES_MIN; lanes <= REGISTER_LANES_MAX; lanes *= 2) emit_value_function(emitter, lanes);
    for (const int *lanes = lane_counts; *lanes > 0; lanes++) {
        const bool is_register = *lanes == 2 || *lanes == 4 || *lanes == 8;
        if (!is_register && !(lanes > lane_counts && *lanes == lanes[-1])) emit_value_function(emitter, *lanes);
    }
    if (lane_counts[0] == 1)
        jet_text_append(emitter->text,
                        "JET_GENERATED_SERIES(%s)\nJET_GENERATED_TANGENTS(%s)\nJET_GENERATED_ADJOINTS(%s)\n", name,
                        name, name);
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
    jet_text_append(emitter->text,
                    "static bool %s_series(const jet_tape *tape, double *x, int k, int lanes)\n{\n"
                    "    if (lanes != 1) return tape->interpreter_sweeps->series(tape, x, k, lanes);\n"
                    "    return %s_series_of(x, k);\n}\n",
                    emitter->request->name_prefix, emitter->request->name_prefix);
}

static void emit_tangents_sweep(const tape_emitter *emitter)
{
    const char *name = emitter->request->name_prefix;
    jet_text_append(emitter->text,
                    "static void %s_tangents(const jet_tape *tape, const double *x, double *dx, int k, int lanes)\n{\n",
                    name);
    for (const int *lanes = emitter->request->tangent_direction_counts; *lanes > 0; lanes++)
        jet_text_append(emitter->text, "    if (lanes == %d) %s_tangents_of(x, dx, k, %d);\n    else\n", *lanes, name,
                        *lanes);
    jet_text_append(emitter->text, "    tape->interpreter_sweeps->tangents(tape, x, dx, k, lanes);\n}\n");
}

static void emit_adjoints_sweep(const tape_emitter *emitter)
{
    const char *name = emitter->request->name_prefix;
    jet_text_append(emitter->text,
                    "static void %s_adjoints(const jet_tape *tape, const double *x, double *bar, int k, int top)\n{\n"
                    "    (void)tape;\n    %s_adjoints_of(x, bar, k, top);\n}\n",
                    name, name);
}

/* Tells whether the request is for values of whole vectors, and for nothing else. */
static bool requests_only_vector_values(const jet_emission_request *request)
{
    for (const int *lanes = request->value_lane_counts; *lanes > 0; lanes++)
        if (*lanes % WHOLE_VECTOR_LANES != 0) return false;
    return !request->needs_series_sweep && !request->needs_adjoint_sweep && request->tangent_direction_counts[0] == 0;
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
    if (!jet_split_runs_into_single_operations(&split, tape, runs_to_split)) {
        text->is_incomplete = true;
        return;
    }
    const tape_emitter emitter = {text, &split, request, operation_count, is_each_run_one_operation};
    emit_tape_arrays(&emitter);
    if (request->needs_adjoint_sweep) emit_adjoints_of_sums(&emitter);
    emit_macros_that_list_all_runs(&emitter);
    emit_functions_for_other_generated_code(&emitter);
    jet_text_append(text, "enum { %s_top = %d };\n", name, request->top_order);
    if (request->value_lane_counts[0] > 0) emit_values_sweep(&emitter);
    if (request->needs_series_sweep) emit_series_sweep(&emitter);
    if (request->tangent_direction_counts[0] > 0) emit_tangents_sweep(&emitter);
    if (request->needs_adjoint_sweep) emit_adjoints_sweep(&emitter);
    jet_text_append(text, "static const jet_sweeps %s_sweeps = {", name);
    if (request->value_lane_counts[0] > 0) jet_text_append(text, ".values = %s_values, ", name);
    if (request->needs_series_sweep) jet_text_append(text, ".series = %s_series, ", name);
    if (request->tangent_direction_counts[0] > 0) jet_text_append(text, ".tangents = %s_tangents, ", name);
    if (request->needs_adjoint_sweep) jet_text_append(text, ".adjoints = %s_adjoints, ", name);
    jet_text_append(text, ".isa = JET_GENERATED_ISA};\n");
    jet_free_split_tape(&split);
}

const jet_sweeps *jet_merge_sweeps(jet_sweeps *merged, const jet_sweeps *interpreted, const jet_sweeps *generated)
{
    *merged = *interpreted;
    if (generated->values) merged->values = generated->values;
    if (generated->series) merged->series = generated->series;
    if (generated->tangents) merged->tangents = generated->tangents;
    if (generated->adjoints) merged->adjoints = generated->adjoints;
    return merged;
}
