/* test_emit.c - Tests that generated code gives what the tape gives: every operation, values and series bit for bit
 * where nothing is fused, and tangents and adjoints that the interpreter computes from this series. All functions are
 * one shared library, made once. */
#include "emit.h"
#include "library.h"
#include "record.h"
#include "suites.h"

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEGREE = 3, SHORT = DEGREE + 1, LANES = 8, DIRECTIONS = 3 };

static library code;

/* Each operation once, and the last compositions. */
static bool is_tested(int i)
{
    if (i >= operation_count) return i >= operation_count + composition_count - 4;
    return i == 0 || strcmp(any_function(i)->name, any_function(i - 1)->name) != 0;
}

/* The tapes of function i: S of its series, V of its values. */
static void emit_function(jet_text *text, int i)
{
    recording series = record_outputs(any_function(i), JET_TAPE_SERIES);
    recording values = record_outputs(any_function(i), JET_TAPE_VALUES);
    char names[2][16];
    snprintf(names[0], sizeof names[0], "S%d", i);
    snprintf(names[1], sizeof names[1], "V%d", i);
    const jet_emission_request of_values = {.name_prefix = names[1], .value_lane_counts = {LANES, 1}};
    const jet_emission_request of_series = {
        .name_prefix = names[0], .value_lane_counts = {1}, .needs_series_sweep = true};
    jet_emit_tape(text, series.tape, &of_series);
    jet_emit_tape(text, values.tape, &of_values);
    recording_free(&series);
    recording_free(&values);
}

static void write_all(jet_text *text)
{
    const int count = operation_count + composition_count;
    jet_emit_rule_source(text);
    for (int i = 0; i < count; i++)
        if (is_tested(i)) emit_function(text, i);
    jet_text_append(text, "typedef struct { const jet_sweeps *of_series, *of_values; } own;\n"
                          "extern const own all[];\nconst own all[] = {\n");
    for (int i = 0; i < count; i++) {
        if (is_tested(i)) jet_text_append(text, "    {&S%d_sweeps, &V%d_sweeps},\n", i, i);
        else jet_text_append(text, "    {0},\n");
    }
    jet_text_append(text, "};\n");
}

/* Once for all tests: by base instructions and sums in the order of the tape's, whose results have the same bits. */
static void make_library(void)
{
    jet_text text = {0};
    setenv("TVI_ISA", "base", 1);
    write_all(&text);
    code = library_make(&text, "-O1 -ffp-contract=off");
}

static void remove_library(void)
{
    library_remove(&code);
    unsetenv("TVI_ISA");
}

/* The results of f in each kind of sweep. */
typedef struct {
    double values[OUTPUTS_MAX * LANES], one[OUTPUTS_MAX], odd[OUTPUTS_MAX * 3], series[OUTPUTS_MAX * SHORT],
        tangent[OUTPUTS_MAX * SHORT], tangents[OUTPUTS_MAX * SHORT * DIRECTIONS], adjoints[INPUTS_MAX * SHORT];
} results;

static int find(const char *name)
{
    int i = 0;
    while (i < operation_count && strcmp(any_function(i)->name, name) != 0) i++;
    ck_assert_int_lt(i, operation_count);
    return i;
}

/* The tapes and sweeps of a function. */
typedef struct {
    const jet_sweeps *of_series, *of_values;
} own_code;

/* NULL: the tape's own. Lanes that the code has not are the interpreter's. */
static void run(const function *f, const own_code *own, results *r)
{
    static double x[INPUTS_MAX * SHORT], dx[INPUTS_MAX * SHORT * DIRECTIONS], zbar[OUTPUTS_MAX * SHORT],
        lanes[INPUTS_MAX * LANES];
    recording series = record_outputs(f, JET_TAPE_SERIES), values = record_outputs(f, JET_TAPE_VALUES);
    jet_sweeps merged[2];
    if (own) series.tape->sweeps = jet_merge_sweeps(&merged[0], series.tape->interpreter_sweeps, own->of_series);
    if (own) values.tape->sweeps = jet_merge_sweeps(&merged[1], values.tape->interpreter_sweeps, own->of_values);
    dense_series(f, DEGREE, x);
    for (int i = 0; i < f->inputs * SHORT * DIRECTIONS; i++) dx[i] = cos(1.0 + i);
    for (int i = 0; i < f->outputs * SHORT; i++) zbar[i] = 1.0 / (1 + i % 7);
    for (int i = 0; i < f->inputs * LANES; i++) lanes[i] = f->centre[i / LANES] + 0.01 * (i % LANES);
    memset(r, 0, sizeof *r);
    ck_assert(run_values(&values, LANES, lanes, r->values));
    ck_assert(run_values(&values, 1, f->centre, r->one));
    for (int i = 0; i < f->inputs * 3; i++) lanes[i] = f->centre[i / 3];
    ck_assert(run_values(&values, 3, lanes, r->odd));
    ck_assert(run_series(&series, DEGREE, 1, x, r->series));
    run_tangents(&series, DEGREE, 1, 1, x, dx, r->tangent);
    run_tangents(&series, DEGREE, 1, DIRECTIONS, x, dx, r->tangents);
    run_adjoints(&series, DEGREE, x, zbar, r->adjoints);
    recording_free(&series);
    recording_free(&values);
}

static const own_code *all(void) { return dlsym(code.handle, "all"); }

START_TEST(code_is_the_tape)
{
    static results tape, own;
    for (int i = 0; i < operation_count + composition_count; i++) {
        const function *f = any_function(i);
        if (!is_tested(i)) continue;
        run(f, NULL, &tape);
        run(f, &all()[i], &own);
        ck_assert_msg(memcmp(&tape, &own, sizeof own) == 0, "%s", f->name);
    }
}
END_TEST

/* The code of another function is not what this one gives: it is the code that runs. */
START_TEST(another_code_is_another_function)
{
    static results tape, other;
    const int i = find("sinh");
    const function *f = any_function(find("sin"));
    run(f, NULL, &tape);
    run(f, &all()[i], &other);
    ck_assert(tape.values[0] != other.values[0] && tape.one[0] != other.one[0] && tape.series[2] != other.series[2]);
    ck_assert(tape.tangents[2 * DIRECTIONS] != other.tangents[2 * DIRECTIONS]);
    ck_assert(tape.adjoints[0] != other.adjoints[0]);
    ck_assert(tape.odd[0] == other.odd[0] && tape.odd[1] == other.odd[1]);
}
END_TEST

START_TEST(outside_is_refused)
{
    const int i = find("log");
    recording r = record_outputs(any_function(i), JET_TAPE_VALUES);
    jet_sweeps own;
    double x[LANES] = {1, 2, 3, 4, 5, 6, 7, 8}, z[LANES];
    r.tape->sweeps = jet_merge_sweeps(&own, r.tape->interpreter_sweeps, all()[i].of_values);
    ck_assert(run_values(&r, LANES, x, z));
    ck_assert(run_values(&r, 1, x, z));
    x[5] = 0;
    ck_assert(!run_values(&r, LANES, x, z));
    ck_assert(!run_values(&r, 1, x + 5, z));
    recording_free(&r);
}
END_TEST

Suite *emit_suite(void)
{
    Suite *suite = suite_create("emit");
    TCase *tests = add_case(suite, "generated code");
    tcase_add_unchecked_fixture(tests, make_library, remove_library);
    tcase_add_test(tests, code_is_the_tape);
    tcase_add_test(tests, another_code_is_another_function);
    tcase_add_test(tests, outside_is_refused);
    add_bodies(suite);
    return suite;
}
