/* test_split.c - Tests tapes whose operations stand alone (split.h). Cases of the suite "tape". */
#include "record.h"
#include "split.h"
#include "suites.h"
#include "problems/thorough.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const jet_runs_to_split ways[] = {JET_SPLIT_NONE, JET_SPLIT_SUMS, JET_SPLIT_ALL};
enum { WAYS = sizeof ways / sizeof *ways, LANES = 8 };

static recording split_of(const recording *r, jet_runs_to_split which, jet_tape *split)
{
    ck_assert(jet_tape_split_runs(split, r->tape, which));
    recording other = *r;
    other.tape = split;
    return other;
}

/* The same values, to roundoff. A slot that is read before it is computed would be no number. */
static void check_values(const recording *r, const function *f, jet_runs_to_split which)
{
    double x[INPUTS_MAX * LANES], want[OUTPUTS_MAX * LANES], got[OUTPUTS_MAX * LANES];
    jet_tape split;
    const recording other = split_of(r, which, &split);
    for (int i = 0; i < f->inputs; i++)
        for (int lane = 0; lane < LANES; lane++) x[i * LANES + lane] = f->centre[i] * (1 + 0.001 * lane);
    ck_assert(run_values(r, LANES, x, want) == run_values(&other, LANES, x, got));
    for (int i = 0; i < r->outputs * LANES; i++)
        ck_assert_double_le(fabs(got[i] - want[i]), 3 * DBL_EPSILON * fabs(want[i]));
    jet_free_split_tape(&split);
}

START_TEST(splits_compute_the_same)
{
    const function *f = any_function(_i);
    for (int kind = JET_TAPE_VALUES; kind <= JET_TAPE_SERIES; kind++)
        for (int way = 0; way < WAYS; way++) {
            recording r = record_outputs(f, (jet_tape_kind)kind), g = record_gradient(f, 0, (jet_tape_kind)kind);
            check_values(&r, f, ways[way]);
            check_values(&g, f, ways[way]);
            recording_free(&r);
            recording_free(&g);
        }
}
END_TEST

/* Whether the split has the operations of such a run alone. */
static bool is_cut(const jet_run_of_operations *run, jet_runs_to_split which)
{
    return which == JET_SPLIT_ALL || (which == JET_SPLIT_SUMS && run->op == OP_LINEAR);
}

/* Each slot once, by the operation that the tape has; alone, if it is one of those to be cut. */
START_TEST(operations_are_made_once)
{
    const function *f = any_function(_i);
    recording r = record_gradient(f, 0, JET_TAPE_VALUES);
    int *makers = calloc((size_t)r.tape->slot_count, sizeof *makers);
    for (int way = 0; way < WAYS; way++) {
        jet_tape split;
        ck_assert(jet_tape_split_runs(&split, r.tape, ways[way]));
        memset(makers, 0, (size_t)r.tape->slot_count * sizeof *makers);
        for (const jet_run_of_operations *run = split.runs; run < split.runs + split.run_count; run++) {
            ck_assert(run->operation_count == 1 || !is_cut(run, ways[way]));
            for (int slot = run->z; slot < run->z + run->operation_count; slot++) makers[slot]++;
        }
        for (int slot = 0; slot < r.tape->slot_count; slot++)
            ck_assert_int_eq(makers[slot], slot >= r.tape->input_count + r.tape->constant_count);
        jet_free_split_tape(&split);
    }
    free(makers);
    recording_free(&r);
}
END_TEST

static const function *gravity(void)
{
    for (int i = 0; i < composition_count; i++)
        if (!strcmp(compositions[i].name, "gravity")) return &compositions[i];
    ck_abort_msg("no gravity");
}

/* The most operations between one that is no sum of multiples and what it reads. */
static int longest_way(const jet_tape *tape)
{
    int *made = calloc((size_t)tape->slot_count, sizeof *made), longest = 0, count = 0;
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++)
        for (int i = 0; i < run->operation_count; i++, count++) {
            made[run->z + i] = count;
            for (int term = run->first_term_index;
                 term < run->first_term_index + run->term_count && run->op != OP_LINEAR; term++) {
                const int first = made[tape->terms.slot[term] + i], second = made[tape->terms.slot_b[term] + i];
                longest = count - first > longest ? count - first : longest;
                longest = count - second > longest ? count - second : longest;
            }
        }
    free(made);
    return longest;
}

/* Three differences, a distance, a power, a factor and three products follow each other, and sums of those between;
 * beside other pairs' they wait for 45 differences. */
START_TEST(pairs_follow_each_other)
{
    recording r = record_outputs(gravity(), JET_TAPE_VALUES);
    jet_tape sums, all;
    ck_assert(jet_tape_split_runs(&sums, r.tape, JET_SPLIT_SUMS));
    ck_assert(jet_tape_split_runs(&all, r.tape, JET_SPLIT_ALL));
    ck_assert_int_ge(longest_way(&sums), 45);
    ck_assert_int_le(longest_way(&all), 12);
    jet_free_split_tape(&sums);
    jet_free_split_tape(&all);
    recording_free(&r);
}
END_TEST

void add_splits(Suite *suite)
{
    TCase *splits = add_case(suite, "splits");
    tcase_add_loop_test(splits, splits_compute_the_same, 0, operation_count + composition_count);
    tcase_add_loop_test(splits, operations_are_made_once, 0, operation_count + composition_count);
    tcase_add_test(splits, pairs_follow_each_other);
}
