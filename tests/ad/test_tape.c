/* test_tape.c - Tests which nodes of a graph are kept on a tape, and in which slots; what runs together is in
 * test_runs.c. */
#include "record.h"
#include "rule.h"
#include "suites.h"
#include "problems/thorough.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(table) ((int)(sizeof table / sizeof table[0]))

/* ---- What a tape keeps ------------------------------------------------------------------------------------------- */

static int all_operations(const jet_tape *tape) { return tape->slot_count - tape->input_count - tape->constant_count; }

/* Values leave out the auxiliary series, which series alone need. */
static const struct {
    const char *name;
    jet_op op, auxiliary;
    int values, series; /* operations on the tape */
} auxiliary_cases[] = {
    {"exp", OP_EXP, OP_EXP, 1, 1},        {"log", OP_LOG, OP_LOG, 1, 1},
    {"sin", OP_SIN, OP_COS, 1, 2},        {"cos", OP_COS, OP_SIN, 1, 2},
    {"sinh", OP_SINH, OP_COSH, 1, 2},     {"cosh", OP_COSH, OP_SINH, 1, 2},
    {"tan", OP_TAN, OP_SQUARES, 1, 3},    {"tanh", OP_TANH, OP_SECH2, 1, 2},
    {"asin", OP_ASIN, OP_SQRT, 1, 5},     {"acos", OP_ACOS, OP_SQRT, 1, 5},
    {"atan", OP_ATAN, OP_SQUARES, 1, 3},  {"sqrt", OP_SQRT, OP_SQRT, 1, 1},
    {"neg", OP_LINEAR, OP_LINEAR, 1, 1},  {"mul", OP_PRODUCTS, OP_PRODUCTS, 1, 1},
    {"div", OP_DIV, OP_DIV, 1, 1},        {"asinh", OP_ASINH, OP_SQRT, 1, 4},
    {"acosh", OP_ACOSH, OP_SQRT, 1, 5},   {"atanh", OP_ATANH, OP_PRODUCTS, 1, 4},
    {"erf", OP_ERF, OP_EXP, 1, 4},        {"hypot", OP_HYPOT, OP_HYPOT, 1, 1},
    {"atan2", OP_ATAN2, OP_RADIUS, 1, 2},
};

START_TEST(values_leave_out_auxiliary_series)
{
    if (is_plain()) return;
    const function f = {auxiliary_cases[_i].name, operation_named(auxiliary_cases[_i].name), 2, 1, 0, {0}, 0};
    recording values = record_outputs(&f, JET_TAPE_VALUES), series = record_outputs(&f, JET_TAPE_SERIES);
    ck_assert_int_eq(operations_of(values.tape, auxiliary_cases[_i].op), 1);
    ck_assert_int_eq(all_operations(values.tape), auxiliary_cases[_i].values);
    ck_assert_int_eq(all_operations(series.tape), auxiliary_cases[_i].series);
    ck_assert_int_ge(operations_of(series.tape, auxiliary_cases[_i].auxiliary), 1);
    recording_free(&values);
    recording_free(&series);
}
END_TEST

/* The derivative of tanh is sech^2 and of sin is cos: the output is the auxiliary series, and a tape of values has it
 * alone. */
static const struct {
    const char *name;
    jet_op op;
} derivatives[] = {{"tanh", OP_SECH2}, {"sin", OP_COS}, {"cosh", OP_SINH}, {"exp", OP_EXP}};

START_TEST(values_of_an_auxiliary_series_are_alone)
{
    const function f = {derivatives[_i].name, operation_named(derivatives[_i].name), 1, 1, 0, {0}, 0};
    recording r = record_gradient(&f, 0, JET_TAPE_VALUES);
    ck_assert_int_eq(operations_of(r.tape, derivatives[_i].op), 1);
    ck_assert_int_eq(all_operations(r.tape), 1);
    recording_free(&r);
}
END_TEST

/* Operations that no output depends on are left out, inputs beyond the first `inputs` too. */
START_TEST(what_is_not_needed_is_left_out)
{
    jet_graph *graph = jet_graph_create(4);
    jet x[4], z[1];
    for (int i = 0; i < 4; i++) x[i] = jet_graph_input(graph, i);
    (void)jet_exp(jet_mul(x[0], x[1]));
    (void)jet_tan(jet_sin(x[3]));
    z[0] = jet_mul(x[1], jet_sqrt(x[2]));
    ck_assert_int_eq(jet_graph_check_outputs(graph, 1, z), TVI_OK);
    jet_graph_end_recording(graph);
    jet_tape *tape = jet_tape_create(graph, 1, 1, z, JET_TAPE_SERIES);
    ck_assert_int_eq(tape->input_count, 3); /* x0, asked for; x1 and x2, needed; x3 is not */
    ck_assert_int_eq(tape->slot_count, 5);
    double block[5] = {7, 3, 16};
    ck_assert(jet_sweep_values(tape, block, 1));
    ck_assert_double_eq(block[tape->output_slot[0]], 12);
    jet_tape_free(tape);
    jet_graph_free(graph);
}
END_TEST

/* Outputs may be inputs, numbers and each other, in any order. */
START_TEST(outputs_may_be_anything)
{
    jet_graph *graph = jet_graph_create(2);
    const jet x = jet_graph_input(graph, 0), y = jet_graph_input(graph, 1), product = jet_mul(x, y);
    const jet next = jet_add(product, 1);
    jet z[] = {product, y, jet_const(2.5), next, product, jet_const(-4), x};
    const double in[] = {3, 0.5, 5, 7}, want[] = {15, 5, 2.5, 16, 15, -4, 3}; /* degree 1 */
    const double slope[] = {3 * 7 + 5 * 0.5, 7, 0, 3 * 7 + 5 * 0.5, 3 * 7 + 5 * 0.5, 0, 0.5};
    double got[2 * COUNT(z)];
    recording r = record_close(graph, COUNT(z), z, JET_TAPE_SERIES);
    ck_assert_int_eq(r.tape->output_count, COUNT(z));
    ck_assert(run_series(&r, 1, 1, in, got));
    for (int i = 0; i < COUNT(z); i++) {
        ck_assert_double_eq(got[2 * i], want[i]);
        ck_assert_double_eq(got[2 * i + 1], slope[i]);
    }
    recording_free(&r);
}
END_TEST

/* A product that is an output and part of a sum is not dissolved in the sum, whichever output it is. */
START_TEST(products_that_are_outputs_stay)
{
    jet_graph *graph = jet_graph_create(3);
    jet x[3];
    for (int i = 0; i < 3; i++) x[i] = jet_graph_input(graph, i);
    const jet product = jet_mul(x[0], x[1]), sum = jet_add(product, jet_mul(x[1], x[2]));
    jet z[2];
    z[_i] = product;
    z[1 - _i] = sum;
    const double in[] = {3, 5, 7};
    double got[2];
    recording r = record_close(graph, 2, z, JET_TAPE_VALUES);
    for (int i = 0; i < 2; i++) ck_assert_int_ge(r.tape->output_slot[i], r.tape->input_count);
    ck_assert(run_values(&r, 1, in, got));
    ck_assert_double_eq(got[_i], 15);
    ck_assert_double_eq(got[1 - _i], 50);
    recording_free(&r);
}
END_TEST

/* ---- Blocks ------------------------------------------------------------------------------------------------------ */

/* Constants at order 0 of every lane, zero at others and for inputs; what is computed is no number yet. */
START_TEST(block_is_prepared)
{
    enum { ORDERS_USED = 3, LANES = 4 };
    jet_graph *graph = jet_graph_create(2);
    jet z[] = {jet_div(3, jet_graph_input(graph, 0)), jet_div(-2, jet_graph_input(graph, 1))};
    recording r = record_close(graph, 2, z, JET_TAPE_SERIES);
    ck_assert_int_eq(r.tape->constant_count, 2);
    const int size = ORDERS_USED * r.tape->slot_count * LANES;
    double *block = numbers((size_t)size);
    for (int i = 0; i < size; i++) block[i] = 7;
    jet_tape_write_constants(r.tape, block, ORDERS_USED, LANES);
    for (int i = 0; i < size; i++) {
        const int constant = i / LANES - r.tape->input_count;
        const bool is_constant = constant >= 0 && constant < r.tape->constant_count;
        if (i / LANES % r.tape->slot_count >= r.tape->input_count + r.tape->constant_count) ck_assert(isnan(block[i]));
        else ck_assert_double_eq(block[i], is_constant ? (constant == 0 ? 3 : -2) : 0);
    }
    free(block);
    recording_free(&r);
}
END_TEST

/* A sweep writes computed slots of its own order and nothing else. */
static void check_untouched(const jet_tape *tape, int k, int degree, const double *before, const double *after)
{
    for (int order = 0; order <= degree; order++)
        for (int slot = 0; slot < tape->slot_count; slot++) {
            const int i = order * tape->slot_count + slot;
            if (order == k && slot >= tape->input_count + tape->constant_count) continue;
            ck_assert_mem_eq(&before[i], &after[i], sizeof *after);
        }
}

START_TEST(sweeps_write_their_own_order)
{
    enum { DEGREE = 4 };
    const function *f = any_function(_i);
    recording r = record_outputs(f, JET_TAPE_SERIES);
    const size_t size = (size_t)((DEGREE + 1) * r.tape->slot_count);
    double *x = numbers(size), *dx = numbers(size), *before = numbers(size);
    jet_tape_write_constants(r.tape, x, DEGREE + 1, 1);
    for (int k = 0; k <= DEGREE; k++)
        for (int i = 0; i < f->inputs; i++) {
            x[k * r.tape->slot_count + i] = k == 0 ? f->centre[i] : 0.1;
            dx[k * r.tape->slot_count + i] = 1;
        }
    for (int k = 0; k <= DEGREE; k++) {
        memcpy(before, x, size * sizeof *x);
        ck_assert(jet_sweep_series(r.tape, x, k, 1));
        check_untouched(r.tape, k, DEGREE, before, x);
        memcpy(before, dx, size * sizeof *x);
        jet_sweep_tangents(r.tape, x, dx, k, 1);
        check_untouched(r.tape, k, DEGREE, before, dx);
    }
    free(x);
    free(dx);
    free(before);
    recording_free(&r);
}
END_TEST

Suite *tape_suite(void)
{
    Suite *suite = suite_create("tape");
    const int functions = operation_count + composition_count;
    TCase *lowering = add_case(suite, "lowering");
    tcase_add_loop_test(lowering, values_leave_out_auxiliary_series, 0, COUNT(auxiliary_cases));
    tcase_add_loop_test(lowering, values_of_an_auxiliary_series_are_alone, 0, COUNT(derivatives));
    tcase_add_test(lowering, what_is_not_needed_is_left_out);
    tcase_add_test(lowering, outputs_may_be_anything);
    tcase_add_loop_test(lowering, products_that_are_outputs_stay, 0, 2);
    TCase *blocks = add_case(suite, "blocks");
    tcase_add_test(blocks, block_is_prepared);
    tcase_add_loop_test(blocks, sweeps_write_their_own_order, 0, functions);
    add_runs(suite);
    add_splits(suite);
    return suite;
}
