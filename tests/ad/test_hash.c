/* test_hash.c - Tests that everything that a sweep reads changes the hash of a tape, and nothing else does. */
#include "record.h"
#include "suites.h"

#include <stdlib.h>

/* Constants, sums with numbers, products, squares, quotients, powers and functions. */
static recording record_all_kinds(void)
{
    jet_graph *graph = jet_graph_create(4);
    jet x[4];
    for (int i = 0; i < 4; i++) x[i] = jet_graph_input(graph, i);
    jet z[] = {
        jet_sin(jet_add(jet_mul(2, x[0]), 3)),
        jet_add(jet_mul(x[0], x[1]), jet_mul(3, jet_mul(x[2], x[3]))),
        jet_div(5, jet_sqr(jet_sub(x[1], x[2]))),
        jet_pow(x[3], -1.5),
    };
    return record_close(graph, 4, z, JET_TAPE_SERIES);
}

static uint64_t hash_of(const jet_tape *tape) { return jet_tape_continue_hash(JET_HASH_OF_NOTHING, tape); }

/* The hash is another one while the member is, and the old one afterwards. */
#define EXPECT_SEEN(tape, member)                                                                                      \
    do {                                                                                                               \
        const uint64_t before = hash_of(tape);                                                                         \
        (member)++;                                                                                                    \
        ck_assert_msg(hash_of(tape) != before, "%s", #member);                                                         \
        (member)--;                                                                                                    \
        ck_assert(hash_of(tape) == before);                                                                            \
    } while (0)

START_TEST(arrays_are_hashed)
{
    recording r = record_all_kinds();
    jet_tape *tape = r.tape;
    ck_assert(tape->constant_count > 0 && tape->linear_operation_count > 0 && tape->terms.count > 0 &&
              tape->output_count == 4);
    for (int i = 0; i < tape->constant_count; i++) EXPECT_SEEN(tape, tape->constant_values[i]);
    for (int i = 0; i < tape->linear_operation_count; i++) EXPECT_SEEN(tape, tape->constant_terms[i]);
    for (int i = 0; i < tape->terms.count; i++) {
        EXPECT_SEEN(tape, tape->terms.slot[i]);
        EXPECT_SEEN(tape, tape->terms.slot_b[i]);
        EXPECT_SEEN(tape, tape->terms.coefficient[i]);
    }
    for (int i = 0; i < tape->output_count; i++) EXPECT_SEEN(tape, tape->output_slot[i]);
    EXPECT_SEEN(tape, tape->input_count);
    EXPECT_SEEN(tape, tape->slot_count);
    recording_free(&r);
}
END_TEST

START_TEST(runs_are_hashed)
{
    recording r = record_all_kinds();
    ck_assert_int_gt(r.tape->run_count, 5);
    for (int i = 0; i < r.tape->run_count; i++) {
        jet_run_of_operations *run = &r.tape->runs[i];
        EXPECT_SEEN(r.tape, run->op);
        EXPECT_SEEN(r.tape, run->operation_count);
        EXPECT_SEEN(r.tape, run->z);
        EXPECT_SEEN(r.tape, run->a);
        EXPECT_SEEN(r.tape, run->b);
        EXPECT_SEEN(r.tape, run->w);
        EXPECT_SEEN(r.tape, run->exponent);
        EXPECT_SEEN(r.tape, run->first_constant_term_index);
        EXPECT_SEEN(r.tape, run->term_count);
        EXPECT_SEEN(r.tape, run->first_term_index);
        EXPECT_SEEN(r.tape, run->has_nonzero_constant_terms);
    }
    recording_free(&r);
}
END_TEST

START_TEST(equal_tapes_have_equal_hashes)
{
    recording a = record_all_kinds(), b = record_all_kinds();
    ck_assert(hash_of(a.tape) == hash_of(b.tape));
    ck_assert(hash_of(a.tape) != hash_of(NULL) && hash_of(NULL) != JET_HASH_OF_NOTHING);
    ck_assert(jet_tape_continue_hash(hash_of(NULL), a.tape) != hash_of(a.tape));
    recording_free(&a);
    recording_free(&b);
}
END_TEST

Suite *hash_suite(void)
{
    Suite *suite = suite_create("hash");
    TCase *tests = add_case(suite, "hash");
    tcase_add_test(tests, arrays_are_hashed);
    tcase_add_test(tests, runs_are_hashed);
    tcase_add_test(tests, equal_tapes_have_equal_hashes);
    return suite;
}
