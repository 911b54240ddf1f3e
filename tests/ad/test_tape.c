/* test_tape.c - from graph to tape: what is kept, where it lies, what runs together. */
#include "record.h"
#include "rule.h"
#include "suites.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(table) ((int)(sizeof table / sizeof table[0]))

/* ---- What a tape keeps ------------------------------------------------------------------------------------------- */

/* How many operations of a kind a tape has. */
static int operations_of(const jet_tape *tape, jet_op op)
{
    int count = 0;
    for (int i = 0; i < tape->runs; i++) count += tape->run[i].op == op ? tape->run[i].count : 0;
    return count;
}

static int all_operations(const jet_tape *tape) { return tape->slots - tape->inputs - tape->constants; }

/* Values leave out the partners, which series alone need. */
static const struct {
    const char *name;
    jet_op op, partner;
    int values, series; /* operations on the tape */
} partners[] = {
    {"exp", OP_EXP, OP_EXP, 1, 1},         {"log", OP_LOG, OP_LOG, 1, 1},
    {"sin", OP_SIN, OP_COS, 1, 2},         {"cos", OP_COS, OP_SIN, 1, 2},
    {"sinh", OP_SINH, OP_COSH, 1, 2},      {"cosh", OP_COSH, OP_SINH, 1, 2},
    {"tan", OP_TAN, OP_SQUARES, 1, 3},     {"tanh", OP_TANH, OP_SECH2, 1, 2},
    {"asin", OP_ASIN, OP_SQRT, 1, 5},      {"acos", OP_ACOS, OP_SQRT, 1, 5},
    {"atan", OP_ATAN, OP_SQUARES, 1, 3},   {"sqrt", OP_SQRT, OP_SQRT, 1, 1},
    {"neg", OP_LINEAR, OP_LINEAR, 1, 1},   {"mul", OP_PRODUCTS, OP_PRODUCTS, 1, 1},
    {"div", OP_DIV, OP_DIV, 1, 1},         {"asinh", OP_ASINH, OP_SQRT, 1, 4},
    {"acosh", OP_ACOSH, OP_SQRT, 1, 5},    {"atanh", OP_ATANH, OP_PRODUCTS, 1, 4},
    {"erf", OP_ERF, OP_EXP, 1, 4},         {"hypot", OP_HYPOT, OP_HYPOT, 1, 1},
    {"atan2", OP_ATAN2, OP_SQUARES, 1, 2},
};

START_TEST(values_leave_out_partners)
{
    const function f = {partners[_i].name, operation_named(partners[_i].name), 2, 1, 0, {0}, 0};
    recording values = record_outputs(&f, JET_TAPE_VALUES), series = record_outputs(&f, JET_TAPE_SERIES);
    ck_assert_int_eq(operations_of(values.tape, partners[_i].op), 1);
    ck_assert_int_eq(all_operations(values.tape), partners[_i].values);
    ck_assert_int_eq(all_operations(series.tape), partners[_i].series);
    ck_assert_int_ge(operations_of(series.tape, partners[_i].partner), 1);
    recording_free(&values);
    recording_free(&series);
}
END_TEST

/* The derivative of tanh is sech^2 and of sin is cos: the output is the partner, and a tape of values has it alone. */
static const struct {
    const char *name;
    jet_op op;
} derivatives[] = {{"tanh", OP_SECH2}, {"sin", OP_COS}, {"cosh", OP_SINH}, {"exp", OP_EXP}};

START_TEST(values_of_a_partner_are_alone)
{
    const function f = {derivatives[_i].name, operation_named(derivatives[_i].name), 1, 1, 0, {0}, 0};
    recording r = record_gradient(&f, 0, JET_TAPE_VALUES);
    ck_assert_int_eq(operations_of(r.tape, derivatives[_i].op), 1);
    ck_assert_int_eq(all_operations(r.tape), 1);
    recording_free(&r);
}
END_TEST

/* What no output depends on is left out, inputs beyond the first `inputs` too. */
START_TEST(what_is_not_needed_is_left_out)
{
    jet_graph *graph = jet_graph_create(4);
    jet x[4], z[1];
    for (int i = 0; i < 4; i++) x[i] = jet_graph_input(graph, i);
    (void)jet_exp(jet_mul(x[0], x[1]));
    (void)jet_tan(jet_sin(x[3]));
    z[0] = jet_mul(x[1], jet_sqrt(x[2]));
    ck_assert_int_eq(jet_graph_accept(graph, 1, z), TVI_OK);
    jet_graph_close(graph);
    jet_tape *tape = jet_tape_create(graph, 1, 1, z, JET_TAPE_SERIES);
    ck_assert_int_eq(tape->inputs, 3); /* x0, asked for; x1 and x2, needed; x3 is not */
    ck_assert_int_eq(tape->slots, 5);
    double block[5] = {7, 3, 16};
    ck_assert(jet_sweep_values(tape, block, 1));
    ck_assert_double_eq(block[tape->output[0]], 12);
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
    ck_assert_int_eq(r.tape->outputs, COUNT(z));
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
    for (int i = 0; i < 2; i++) ck_assert_int_ge(r.tape->output[i], r.tape->inputs);
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
    ck_assert_int_eq(r.tape->constants, 2);
    const int size = ORDERS_USED * r.tape->slots * LANES;
    double *block = numbers((size_t)size);
    for (int i = 0; i < size; i++) block[i] = 7;
    jet_tape_prepare(r.tape, block, ORDERS_USED, LANES);
    for (int i = 0; i < size; i++) {
        const int constant = i / LANES - r.tape->inputs;
        const bool is_constant = constant >= 0 && constant < r.tape->constants;
        if (i / LANES % r.tape->slots >= r.tape->inputs + r.tape->constants) ck_assert(isnan(block[i]));
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
        for (int slot = 0; slot < tape->slots; slot++) {
            const int i = order * tape->slots + slot;
            if (order == k && slot >= tape->inputs + tape->constants) continue;
            ck_assert_mem_eq(&before[i], &after[i], sizeof *after);
        }
}

START_TEST(sweeps_write_their_own_order)
{
    enum { DEGREE = 4 };
    const function *f = any_function(_i);
    recording r = record_outputs(f, JET_TAPE_SERIES);
    const size_t size = (size_t)((DEGREE + 1) * r.tape->slots);
    double *x = numbers(size), *dx = numbers(size), *before = numbers(size);
    jet_tape_prepare(r.tape, x, DEGREE + 1, 1);
    for (int k = 0; k <= DEGREE; k++)
        for (int i = 0; i < f->inputs; i++) {
            x[k * r.tape->slots + i] = k == 0 ? f->centre[i] : 0.1;
            dx[k * r.tape->slots + i] = 1;
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

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

static bool is_product(const jet_run *run) { return run->op == OP_PRODUCTS || run->op == OP_SQUARES; }

/* Runs follow each other without gaps and read, at the order being computed, only slots that are computed before; each
 * LINEAR has a row of terms, as many as the others of its run; the products of a run have one set of terms. */
static void check_layout(const jet_tape *tape, jet_tape_kind kind)
{
    int slot = tape->inputs + tape->constants, row = 0, term = 0;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) {
        const jet_rule *rule = jet_rules[run->op];
        ck_assert_int_eq(run->z, slot);
        ck_assert_int_ge(run->count, 1);
        slot += run->count;
        ck_assert_int_le(slot, tape->slots);
        if (rule && rule->operands == 2) ck_assert_int_le(run->b + run->count, run->z);
        if (rule && rule->partner == W_SAME && kind == JET_TAPE_SERIES) ck_assert_int_le(run->w + run->count, run->z);
        if (run->op != OP_LINEAR && !is_product(run)) {
            ck_assert_int_le(run->a + run->count, run->z);
            continue;
        }
        ck_assert_int_eq(run->term, term);
        if (is_product(run)) {
            ck_assert_int_ge(run->terms, 1);
            ck_assert_int_le(run->terms, JET_TERMS_MAX);
            for (int i = 0; i < run->terms; i++, term++) {
                ck_assert_int_le(tape->term_slot[term] + run->count, run->z);
                ck_assert_int_le(tape->term_second[term] + run->count, run->z);
            }
            continue;
        }
        ck_assert_int_eq(run->first, row);
        row += run->count;
        for (int i = 0; i < run->count * run->terms; i++, term++) ck_assert_int_lt(tape->term_slot[term], run->z);
    }
    ck_assert_int_eq(term, tape->terms);
    ck_assert_int_eq(slot, tape->slots);
    ck_assert_int_eq(row, tape->rows);
}

START_TEST(tapes_are_laid_out)
{
    const function *f = any_function(_i);
    for (int kind = JET_TAPE_VALUES; kind <= JET_TAPE_SERIES; kind++) {
        recording r = record_outputs(f, (jet_tape_kind)kind), g = record_gradient(f, 0, (jet_tape_kind)kind);
        check_layout(r.tape, (jet_tape_kind)kind);
        check_layout(g.tape, (jet_tape_kind)kind);
        recording_free(&r);
        recording_free(&g);
    }
}
END_TEST

/* How many runs of a kind a tape has. */
static int runs_of(const jet_tape *tape, jet_op op)
{
    int runs = 0;
    for (int i = 0; i < tape->runs; i++) runs += tape->run[i].op == op;
    return runs;
}

static const function *composition_named(const char *name)
{
    for (int i = 0; i < composition_count; i++)
        if (!strcmp(compositions[i].name, name)) return &compositions[i];
    ck_abort_msg("no composition %s", name);
}

/* The 15 pairs of six bodies run side by side: 45 differences, 15 distances, powers and factors; then, axis by axis and
 * without copies of the factors, 45 components of forces, and 72 additions in four levels. */
START_TEST(pairs_run_together)
{
    static const struct {
        jet_op op;
        int operations, runs;
    } expected[] = {{OP_SQUARES, 15, 1}, {OP_POW, 15, 1}, {OP_PRODUCTS, 45, 3}, {OP_LINEAR, 45 + 15 + 72, 2 + 4}};
    recording r = record_outputs(composition_named("gravity"), (jet_tape_kind)_i);
    for (int i = 0; i < COUNT(expected); i++) {
        ck_assert_int_eq(operations_of(r.tape, expected[i].op), expected[i].operations);
        ck_assert_int_eq(runs_of(r.tape, expected[i].op), expected[i].runs);
    }
    recording_free(&r);
}
END_TEST

enum { COPIES = 12 };

/* Copies of f side by side: input j of copy i is x[j][i]. */
static recording record_copies(const function *f, jet_tape_kind kind)
{
    jet_graph *graph = jet_graph_create(f->inputs * COPIES);
    jet z[COPIES], x[INPUTS_MAX];
    for (int i = 0; i < COPIES; i++) {
        for (int j = 0; j < f->inputs; j++) x[j] = jet_graph_input(graph, j * COPIES + i);
        f->record(f->c, x, &z[i]);
    }
    return record_close(graph, COPIES, z, kind);
}

/* Whether the operands of copies are adjacent on every level: 1 / x has one numerator for all, and 1 - x and 1 + x,
 * whose product the inverse functions need, alternate. */
static bool stays_adjacent(const function *f)
{
    static const char *const alternate[] = {"asin", "acos", "acosh", "atanh"};
    for (int i = 0; i < COUNT(alternate); i++)
        if (strcmp(f->name, alternate[i]) == 0) return false;
    return f->c != -1;
}

/* Twelve copies of an operation take as many runs as one, each with twelve members; each copy has its value. */
START_TEST(copies_run_together)
{
    const function *f = &operations[_i];
    double x[INPUTS_MAX * COPIES], z[COPIES], want;
    for (int i = 0; i < f->inputs * COPIES; i++) x[i] = f->centre[i / COPIES];
    for (int kind = JET_TAPE_VALUES; kind <= JET_TAPE_SERIES; kind++) {
        recording one = record_outputs(f, (jet_tape_kind)kind), many = record_copies(f, (jet_tape_kind)kind);
        if (stays_adjacent(f)) ck_assert_int_eq(many.tape->runs, one.tape->runs);
        for (int i = 0; i < one.tape->runs && stays_adjacent(f); i++)
            ck_assert_int_eq(many.tape->run[i].count, COPIES * one.tape->run[i].count);
        ck_assert(run_values(&one, 1, f->centre, &want));
        ck_assert(run_values(&many, 1, x, z));
        for (int i = 0; i < COPIES; i++) ck_assert_double_eq(z[i], want);
        recording_free(&one);
        recording_free(&many);
    }
}
END_TEST

/* Operations recorded in any order, mixed with others, come to lie by operands: sin of inputs 0 .. 6, recorded as
 * 0 3 6 2 5 1 4, and two powers of each. */
START_TEST(scattered_operations_run_together)
{
    enum { MANY = 7 };
    jet_graph *graph = jet_graph_create(MANY);
    jet z[3 * MANY];
    double x[MANY], got[3 * MANY];
    for (int i = 0; i < MANY; i++) {
        const int place = 3 * i % MANY;
        const jet a = jet_graph_input(graph, place);
        z[3 * place] = jet_sin(a);
        z[3 * place + 1] = jet_pow(a, 1.5);
        z[3 * place + 2] = jet_pow(a, -2.5);
        x[i] = 1 + i;
    }
    recording r = record_close(graph, 3 * MANY, z, (jet_tape_kind)_i);
    ck_assert_int_eq(runs_of(r.tape, OP_SIN), 1);
    ck_assert_int_eq(runs_of(r.tape, OP_POW), 2);
    ck_assert(run_values(&r, 1, x, got));
    for (int i = 0; i < MANY; i++) {
        ck_assert_double_eq(got[3 * i], sin(x[i]));
        ck_assert_double_eq_tol(got[3 * i + 1], pow(x[i], 1.5), 1e-14);
        ck_assert_double_eq_tol(got[3 * i + 2], pow(x[i], -2.5), 1e-15);
    }
    recording_free(&r);
}
END_TEST

/* Operands that do not stand side by side are copied, so that the products run as one. */
START_TEST(scattered_operands_are_gathered)
{
    jet_graph *graph = jet_graph_create(4);
    jet in[4], z[2];
    for (int i = 0; i < 4; i++) in[i] = jet_graph_input(graph, i);
    z[0] = jet_mul(in[0], in[3]);
    z[1] = jet_mul(in[1], in[2]);
    recording r = record_close(graph, 2, z, JET_TAPE_VALUES);
    const double x[4] = {2, 3, 5, 7};
    double got[2];
    ck_assert_int_eq(runs_of(r.tape, OP_PRODUCTS), 1);
    ck_assert_int_eq(operations_of(r.tape, OP_LINEAR), 2);
    ck_assert(run_values(&r, 1, x, got));
    ck_assert_double_eq(got[0], 14);
    ck_assert_double_eq(got[1], 15);
    recording_free(&r);
}
END_TEST

/* Those that several products share are read in turns, without copies: 0 3, 1 4; then 0 2. */
START_TEST(shared_operands_are_read_in_turns)
{
    jet_graph *graph = jet_graph_create(5);
    jet in[5], z[3];
    for (int i = 0; i < 5; i++) in[i] = jet_graph_input(graph, i);
    z[0] = jet_mul(in[0], in[3]);
    z[1] = jet_mul(in[0], in[2]);
    z[2] = jet_mul(in[1], in[4]);
    recording r = record_close(graph, 3, z, JET_TAPE_VALUES);
    const double x[5] = {2, 3, 5, 7, 11};
    double got[3];
    ck_assert_int_eq(runs_of(r.tape, OP_PRODUCTS), 2);
    ck_assert_int_eq(operations_of(r.tape, OP_LINEAR), 0);
    ck_assert(run_values(&r, 1, x, got));
    ck_assert_double_eq(got[0], 14);
    ck_assert_double_eq(got[1], 10);
    ck_assert_double_eq(got[2], 33);
    recording_free(&r);
}
END_TEST

/* What becomes of sums of products (functions.c): one operation each, but of more terms than one takes, with a number,
 * and where something else needs one of the products. */
START_TEST(sums_of_products_are_one_operation)
{
    recording r = record_outputs(composition_named("products"), (jet_tape_kind)_i);
    ck_assert_int_eq(operations_of(r.tape, OP_SQUARES), 2);          /* z0; the square in z6 */
    ck_assert_int_eq(operations_of(r.tape, OP_PRODUCTS), 4 + 5 + 2); /* z1 .. z4; those of z5; two for z7 and z8 */
    ck_assert_int_eq(operations_of(r.tape, OP_LINEAR), 4);           /* z5, z6, z7, z8 */
    recording_free(&r);
}
END_TEST

/* Powers with different exponents do not run together, those with the same do, wherever their operands stand. */
START_TEST(exponents_run_apart)
{
    jet_graph *graph = jet_graph_create(4);
    jet z[4];
    const double x[4] = {4, 4, 4, 4}, want[4] = {8, 0.125, 8, 32};
    const double exponent[4] = {1.5, -1.5, 1.5, 2.5};
    double got[4];
    for (int i = 0; i < 4; i++) z[i] = jet_pow(jet_graph_input(graph, i), exponent[i]);
    recording r = record_close(graph, 4, z, JET_TAPE_SERIES);
    ck_assert_int_eq(runs_of(r.tape, OP_POW), 3);
    ck_assert(run_values(&r, 1, x, got));
    for (int i = 0; i < 4; i++) ck_assert_double_eq(got[i], want[i]);
    recording_free(&r);
}
END_TEST

Suite *tape_suite(void)
{
    Suite *suite = suite_create("tape");
    const int functions = operation_count + composition_count;
    TCase *lowering = add_case(suite, "lowering");
    tcase_add_loop_test(lowering, values_leave_out_partners, 0, COUNT(partners));
    tcase_add_loop_test(lowering, values_of_a_partner_are_alone, 0, COUNT(derivatives));
    tcase_add_test(lowering, what_is_not_needed_is_left_out);
    tcase_add_test(lowering, outputs_may_be_anything);
    tcase_add_loop_test(lowering, products_that_are_outputs_stay, 0, 2);
    TCase *blocks = add_case(suite, "blocks");
    tcase_add_test(blocks, block_is_prepared);
    tcase_add_loop_test(blocks, sweeps_write_their_own_order, 0, functions);
    TCase *runs = add_case(suite, "runs");
    tcase_add_loop_test(runs, tapes_are_laid_out, 0, functions);
    tcase_add_loop_test(runs, pairs_run_together, JET_TAPE_VALUES, JET_TAPE_SERIES + 1);
    tcase_add_loop_test(runs, copies_run_together, 0, operation_count);
    tcase_add_loop_test(runs, scattered_operations_run_together, JET_TAPE_VALUES, JET_TAPE_SERIES + 1);
    tcase_add_test(runs, scattered_operands_are_gathered);
    tcase_add_test(runs, shared_operands_are_read_in_turns);
    tcase_add_loop_test(runs, sums_of_products_are_one_operation, JET_TAPE_VALUES, JET_TAPE_SERIES + 1);
    tcase_add_test(runs, exponents_run_apart);
    return suite;
}
