/* test_runs.c - Tests where the operations of a tape lie, and what runs together. Cases of the suite "tape". */
#include "record.h"
#include "rule.h"
#include "suites.h"
#include "problems/thorough.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(table) ((int)(sizeof table / sizeof table[0]))

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

static bool is_product(const jet_run_of_operations *run) { return run->op == OP_PRODUCTS || run->op == OP_SQUARES; }

/* Runs follow each other without gaps, and read, at the order being computed, only slots that are
 * computed before; each LINEAR has a row of terms, as many as the others of its run; the products of a run have one set
 * of terms. */
static void check_layout(const jet_tape *tape, jet_tape_kind kind)
{
    int slot = tape->input_count + tape->constant_count, row = 0, term = 0;
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++) {
        const jet_rule *rule = jet_rules[run->op];
        ck_assert_int_eq(run->z, slot);
        ck_assert_int_ge(run->operation_count, 1);
        slot = run->z + run->operation_count;
        ck_assert_int_le(slot, tape->slot_count);
        if (rule && rule->operand_count == 2) ck_assert_int_le(run->b + run->operation_count, run->z);
        if (rule && rule->auxiliary_series_orders_read == W_SAME && kind == JET_TAPE_SERIES)
            ck_assert_int_le(run->w + run->operation_count, run->z);
        if (run->op != OP_LINEAR && !is_product(run)) {
            ck_assert_int_le(run->a + run->operation_count, run->z);
            continue;
        }
        ck_assert_int_eq(run->first_term_index, term);
        if (is_product(run)) {
            ck_assert_int_ge(run->term_count, 1);
            ck_assert_int_le(run->term_count, JET_TERMS_MAX);
            for (int i = 0; i < run->term_count; i++, term++) {
                ck_assert_int_le(tape->terms.slot[term] + run->operation_count, run->z);
                ck_assert_int_le(tape->terms.slot_b[term] + run->operation_count, run->z);
            }
            continue;
        }
        ck_assert_int_eq(run->first_constant_term_index, row);
        row += run->operation_count;
        for (int i = 0; i < run->operation_count * run->term_count; i++, term++)
            ck_assert_int_lt(tape->terms.slot[term], run->z);
    }
    ck_assert_int_eq(term, tape->terms.count);
    ck_assert_int_eq(tape->slot_count, slot);
    ck_assert_int_eq(row, tape->linear_operation_count);
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
    for (int i = 0; i < tape->run_count; i++) runs += tape->runs[i].op == op;
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
    if (is_plain()) return;
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
        if (stays_adjacent(f)) ck_assert_int_eq(many.tape->run_count, one.tape->run_count);
        for (int i = 0; i < one.tape->run_count && stays_adjacent(f); i++)
            ck_assert_int_eq(many.tape->runs[i].operation_count, COPIES * one.tape->runs[i].operation_count);
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
        ck_assert_double_eq_tol(got[3 * i], sin(x[i]), 0x1p-52);
        ck_assert_double_eq_tol(got[3 * i + 1], pow(x[i], 1.5), 1e-14);
        ck_assert_double_eq_tol(got[3 * i + 2], pow(x[i], -2.5), 1e-15);
    }
    recording_free(&r);
}
END_TEST

/* Operands that do not stand side by side are copied, so that the products run as one. */
START_TEST(scattered_operands_are_gathered)
{
    const jet_tape_kind kind = (jet_tape_kind)_i;
    jet_graph *graph = jet_graph_create(4);
    jet in[4], z[2];
    for (int i = 0; i < 4; i++) in[i] = jet_graph_input(graph, i);
    z[0] = jet_mul(in[0], in[3]);
    z[1] = jet_mul(in[1], in[2]);
    recording r = record_close(graph, 2, z, kind);
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

/* Operands that several products share are read in turns, without copies: 0 3, 1 4; then 0 2. */
START_TEST(shared_operands_are_read_in_turns)
{
    const jet_tape_kind kind = (jet_tape_kind)_i;
    jet_graph *graph = jet_graph_create(5);
    jet in[5], z[3];
    for (int i = 0; i < 5; i++) in[i] = jet_graph_input(graph, i);
    z[0] = jet_mul(in[0], in[3]);
    z[1] = jet_mul(in[0], in[2]);
    z[2] = jet_mul(in[1], in[4]);
    recording r = record_close(graph, 3, z, kind);
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

/* Sums of products (functions.c) become one operation each, except those of more terms than one takes, with a number,
 * and where something else needs one of the products. A library without devices has all squares and products apart
 * from their sums; by this make check-plain knows that it tests such a one. */
START_TEST(sums_of_products_are_one_operation)
{
    recording r = record_outputs(composition_named("products"), (jet_tape_kind)_i);
    if (is_plain()) {
        ck_assert_int_eq(operations_of(r.tape, OP_SQUARES), 3 + 2);                  /* z0; z3, z6 */
        ck_assert_int_eq(operations_of(r.tape, OP_PRODUCTS), 1 + 2 + 1 + 4 + 5 + 2); /* z1 .. z5; z7 and z8 */
        recording_free(&r);
        return;
    }
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

void add_runs(Suite *suite)
{
    TCase *runs = add_case(suite, "runs");
    tcase_add_loop_test(runs, tapes_are_laid_out, 0, operation_count + composition_count);
    tcase_add_loop_test(runs, pairs_run_together, JET_TAPE_VALUES, JET_TAPE_SERIES + 1);
    tcase_add_loop_test(runs, copies_run_together, 0, operation_count);
    tcase_add_loop_test(runs, scattered_operations_run_together, JET_TAPE_VALUES, JET_TAPE_SERIES + 1);
    tcase_add_loop_test(runs, scattered_operands_are_gathered, JET_TAPE_VALUES, JET_TAPE_SERIES + 1);
    tcase_add_loop_test(runs, shared_operands_are_read_in_turns, JET_TAPE_VALUES, JET_TAPE_SERIES + 1);
    tcase_add_loop_test(runs, sums_of_products_are_one_operation, JET_TAPE_VALUES, JET_TAPE_SERIES + 1);
    tcase_add_test(runs, exponents_run_apart);
}
