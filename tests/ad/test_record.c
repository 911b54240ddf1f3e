/* test_record.c - Tests how operations are recorded: refusals, slots, long sums; sharing is in test_sharing.c. */
#include "record.h"
#include "suites.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(table) ((int)(sizeof table / sizeof table[0]))

/* ---- Refusals ---------------------------------------------------------------------------------------------------- */

/* row(name, result, status): x is a jet of the graph, other of another, closed of a closed one. */
#define REFUSALS(ROW)                                                                                                  \
    ROW(nothing_wrong, jet_sin(x), TVI_OK)                                                                             \
    ROW(just_a_number, jet_const(3), TVI_OK)                                                                           \
    ROW(an_input, x, TVI_OK)                                                                                           \
    ROW(unset, jet_make_unset_poison(), TVI_EINVAL)                                                                    \
    ROW(unset_used, jet_add(x, jet_make_unset_poison()), TVI_EINVAL)                                                   \
    ROW(unset_alone, jet_exp(jet_make_unset_poison()), TVI_EINVAL)                                                     \
    ROW(unset_to_power, jet_pow(jet_make_unset_poison(), 0), TVI_EINVAL)                                               \
    ROW(unset_times_zero, jet_mul(0, jet_make_unset_poison()), TVI_EINVAL)                                             \
    ROW(unset_in_sum, jet_sum((const jet[]){x, jet_make_unset_poison(), x}, 3), TVI_EINVAL)                            \
    ROW(unset_in_dot, jet_dot((const jet[]){x, jet_make_unset_poison()}, (const jet[]){x, x}, 2), TVI_EINVAL)          \
    ROW(unset_far_down, jet_sin(jet_mul(2, jet_sub(jet_make_unset_poison(), x))), TVI_EINVAL)                          \
    ROW(another, other, TVI_EINVAL)                                                                                    \
    ROW(another_alone, jet_sin(other), TVI_EINVAL)                                                                     \
    ROW(mixed_sum, jet_add(x, other), TVI_EINVAL)                                                                      \
    ROW(mixed_difference, jet_sub(other, x), TVI_EINVAL)                                                               \
    ROW(mixed_product, jet_mul(x, other), TVI_EINVAL)                                                                  \
    ROW(mixed_quotient, jet_div(other, x), TVI_EINVAL)                                                                 \
    ROW(mixed_dot, jet_dot(&x, &other, 1), TVI_EINVAL)                                                                 \
    ROW(mixed_far_down, jet_exp(jet_mul(x, jet_sin(other))), TVI_EINVAL)                                               \
    ROW(closed_alone, closed, TVI_EINVAL)                                                                              \
    ROW(closed_function, jet_sin(closed), TVI_EINVAL)                                                                  \
    ROW(closed_scaled, jet_mul(2, closed), TVI_EINVAL)                                                                 \
    ROW(closed_shared, jet_sqr(closed), TVI_EINVAL)                                                                    \
    ROW(closed_power, jet_pow(closed, 1.5), TVI_EINVAL)                                                                \
    ROW(closed_divisor, jet_div(1, closed), TVI_EINVAL)                                                                \
    ROW(closed_sum, jet_sum(&closed, 1), TVI_EINVAL)                                                                   \
    ROW(closed_and_open, jet_add(x, closed), TVI_EINVAL)                                                               \
    ROW(no_function, jet_record_function(JET_FUNCTION_COUNT, x), TVI_EINVAL)                                           \
    ROW(no_function_of_a_number, jet_record_function(JET_FUNCTION_COUNT, jet_const(2)), TVI_EINVAL)                    \
    ROW(no_function_by_far, jet_record_function((jet_function)1000000, x), TVI_EINVAL)                                 \
    ROW(no_function_of_two, jet_record_function2(JET_FUNCTION2_COUNT, x, x), TVI_EINVAL)                               \
    ROW(no_function_below, jet_record_function((jet_function)-1, x), TVI_EINVAL)                                       \
    ROW(not_finite, jet_const(INFINITY), TVI_ENONFINITE)                                                               \
    ROW(not_a_number, jet_const(NAN), TVI_ENONFINITE)                                                                  \
    ROW(not_finite_added, jet_add(x, INFINITY), TVI_ENONFINITE)                                                        \
    ROW(not_a_number_times, jet_mul(NAN, x), TVI_ENONFINITE)                                                           \
    ROW(not_a_number_in_function, jet_sqrt(NAN), TVI_ENONFINITE)                                                       \
    ROW(over_infinity, jet_div(x, INFINITY), TVI_ENONFINITE)                                                           \
    ROW(infinite_exponent, jet_pow(x, INFINITY), TVI_ENONFINITE)                                                       \
    ROW(exponent_not_a_number, jet_pow(2, NAN), TVI_ENONFINITE)                                                        \
    ROW(exp_overflows, jet_exp(1000), TVI_ENONFINITE)                                                                  \
    ROW(power_overflows, jet_pow(1e200, 2), TVI_ENONFINITE)                                                            \
    ROW(root_power_overflows, jet_pow(1e-200, -2.5), TVI_ENONFINITE)                                                   \
    ROW(product_overflows, jet_mul(1e200, 1e200), TVI_ENONFINITE)                                                      \
    ROW(quotient_overflows, jet_div(1e200, 1e-200), TVI_ENONFINITE)                                                    \
    ROW(sum_overflows, jet_add(1.7e308, 1.7e308), TVI_ENONFINITE)                                                      \
    ROW(added_overflows, jet_sum((const jet[]){x, jet_const(1.7e308), jet_const(1.7e308)}, 3), TVI_ENONFINITE)         \
    ROW(coefficient_overflows, jet_mul(1e200, jet_mul(1e200, x)), TVI_ENONFINITE)                                      \
    ROW(overflow_used, jet_add(x, jet_exp(1000)), TVI_ENONFINITE)                                                      \
    ROW(root_of_zero, jet_sqrt(0), TVI_EDOMAIN)                                                                        \
    ROW(log_of_zero, jet_log(0), TVI_EDOMAIN)                                                                          \
    ROW(asin_of_one, jet_asin(1), TVI_EDOMAIN)                                                                         \
    ROW(power_of_zero, jet_pow(0, 1.5), TVI_EDOMAIN)                                                                   \
    ROW(reciprocal_of_zero, jet_pow(0, -1), TVI_EDOMAIN)                                                               \
    ROW(over_zero, jet_div(1, 0), TVI_EDOMAIN)                                                                         \
    ROW(jet_over_zero, jet_div(x, 0), TVI_EDOMAIN)                                                                     \
    ROW(domain_used, jet_sub(x, jet_mul(x, jet_log(-1))), TVI_EDOMAIN)                                                 \
    ROW(domain_times_zero, jet_mul(0, jet_log(-1)), TVI_EDOMAIN)                                                       \
    ROW(domain_in_sum, jet_sum((const jet[]){jet_log(-1), jet_sqr(x)}, 2), TVI_EDOMAIN)

#define REFUSED(name, result, status)                                                                                  \
    static jet refuse_##name(jet x, jet other, jet closed) { return (void)x, (void)other, (void)closed, result; }
REFUSALS(REFUSED)

#define REFUSAL(name, result, status) {#name, refuse_##name, status},
static const struct {
    const char *name;
    jet (*build)(jet x, jet other, jet closed);
    tvi_status status;
} refusals[] = {REFUSALS(REFUSAL)};

/* The status of the outputs (input, result): the first is right, so that the second is seen to be looked at. */
static tvi_status refusal(int i, jet_graph *graph, jet_graph *other, jet_graph *closed)
{
    const jet x = jet_graph_input(graph, 1);
    jet output[2] = {x, refusals[i].build(x, jet_graph_input(other, 0), jet_graph_input(closed, 0))};
    return jet_graph_check_outputs(graph, 2, output);
}

START_TEST(outputs_are_refused)
{
    jet_graph *graph = jet_graph_create(2), *other = jet_graph_create(1), *closed = jet_graph_create(1);
    (void)jet_sqr(jet_graph_input(closed, 0));
    jet_graph_end_recording(closed);
    const int closed_count = jet_graph_node_count(closed);
    const tvi_status status = refusal(_i, graph, other, closed);
    ck_assert_msg(status == refusals[_i].status, "%s: status %d instead of %d", refusals[_i].name, status,
                  refusals[_i].status);
    ck_assert_int_eq(jet_graph_node_count(closed), closed_count);
    jet_graph_free(graph);
    jet_graph_free(other);
    jet_graph_free(closed);
}
END_TEST

/* Numbers become constant nodes, equal ones the same. */
START_TEST(accepted_numbers_are_constants)
{
    jet_graph *graph = jet_graph_create(1);
    jet output[4] = {jet_const(2.5), jet_graph_input(graph, 0), jet_const(-1), jet_const(2.5)};
    ck_assert_int_eq(jet_graph_check_outputs(graph, 4, output), TVI_OK);
    ck_assert_int_eq(jet_graph_node_count(graph), 3);
    ck_assert_int_eq(output[0].node->op, OP_CONST);
    ck_assert_double_eq(output[0].node->number, 2.5);
    ck_assert_double_eq(output[2].node->number, -1);
    ck_assert_ptr_eq(output[3].node, output[0].node);
    ck_assert_ptr_eq(output[1].node, jet_graph_node_at(graph, 0));
    jet_graph_free(graph);
}
END_TEST

/* ---- Slots ------------------------------------------------------------------------------------------------------- */

#define STEP(inner)   jet_add(1, jet_mul(x[0], inner))
#define STEP_5(inner) STEP(STEP(STEP(STEP(STEP(inner)))))

/* 1 + x (1 + x (1 + ...)), nested 20 deep, written out by the preprocessor: it compiles at once, because no slot names
 * its argument twice (2^40 copies otherwise). */
static void record_nested(double c, const jet x[], jet z[])
{
    (void)c;
    z[0] = STEP_5(STEP_5(STEP_5(STEP_5(1))));
}

/* 1 + x + .. + x^20 at 1 + s: coefficient k is binomial(21, k + 1). */
START_TEST(nesting_is_free)
{
    enum { DEGREE = 20 };
    const function f = {"nested", record_nested, 1, 1, 0, {1}, 0};
    recording r = record_outputs(&f, JET_TAPE_SERIES);
    double x[DEGREE + 1] = {1, 1}, z[DEGREE + 1], binomial = 21;
    ck_assert(run_series(&r, DEGREE, 1, x, z));
    for (int k = 0; k <= DEGREE; k++) {
        ck_assert_double_eq(z[k], binomial);
        binomial = binomial * (DEGREE - k) / (k + 2);
    }
    recording_free(&r);
}
END_TEST

/* Every kind of ordinary number in every place of an operation, variables and expressions too. */
static void record_slots(double c, const jet x[], jet z[])
{
    const int two = 2;
    const double half = 0.5;
    jet own = x[0];
    z[0] = jet_mul(two, own);
    z[1] = jet_mul(own, half);
    z[2] = jet_add(two + 1, jet_sub(x[0], half * 3));
    z[3] = jet_sub(c, own);
    z[4] = jet_div(jet_add(x[0], 1), two);
    z[5] = jet_div(6, jet_exp(0));
    z[6] = two > 1 ? own : jet_const(0);
    z[7] = jet_pow(jet_sqr(own), two - 1);
}

START_TEST(slots_take_numbers)
{
    const function f = {"slots", record_slots, 1, 8, 7, {3}, 0};
    static const double want[] = {6, 1.5, 4.5, 4, 2, 6, 3, 9};
    recording r = record_outputs(&f, JET_TAPE_VALUES);
    double z[8];
    ck_assert(run_values(&r, 1, f.centre, z));
    for (int i = 0; i < 8; i++) ck_assert_double_eq(z[i], want[i]);
    recording_free(&r);
}
END_TEST

/* ---- Long sums --------------------------------------------------------------------------------------------------- */

enum { LONG = 100000 };

static void record_long(const jet in[], jet z[])
{
    z[0] = jet_sum(in, LONG);
    z[1] = jet_dot(in, in, LONG);
}

START_TEST(long_sums_are_right)
{
    jet_graph *graph = jet_graph_create(LONG);
    jet *in = malloc(LONG * sizeof *in), z[2];
    double *x = numbers(LONG), got[2], sum = 0, squares = 0;
    ck_assert_ptr_nonnull(in);
    for (int i = 0; i < LONG; i++) {
        in[i] = jet_graph_input(graph, i);
        x[i] = i % 1000 - 300;
        sum += x[i];
        squares += x[i] * x[i];
    }
    record_long(in, z);
    recording r = record_close(graph, 2, z, JET_TAPE_VALUES);
    ck_assert_int_lt(jet_graph_hash_collision_count(graph), 2 * jet_graph_node_count(graph));
    ck_assert_int_eq(jet_graph_node_count(graph), LONG + LONG + 2);
    ck_assert(run_values(&r, 1, x, got));
    ck_assert_double_eq(got[0], sum);
    ck_assert_double_eq(got[1], squares);
    recording_free(&r);
    free(in);
    free(x);
}
END_TEST

/* The same jet again and again, and jets added in the order in which they stand: (1e16 + 1) - 1e16 = 0 in doubles. */
START_TEST(sums_keep_their_order)
{
    jet_graph *graph = jet_graph_create(3);
    const jet a = jet_graph_input(graph, 0), b = jet_graph_input(graph, 1), c = jet_graph_input(graph, 2);
    jet z[3] = {jet_sum((const jet[]){a, b, c}, 3), jet_sum((const jet[]){a, c, b}, 3),
                jet_sum((const jet[]){b, a, b, b, a}, 5)};
    const double x[] = {1e16, 1, -1e16};
    double got[3];
    recording r = record_close(graph, 3, z, JET_TAPE_VALUES);
    ck_assert(run_values(&r, 1, x, got));
    ck_assert_double_eq(got[0], 0);
    ck_assert_double_eq(got[1], 1);
    ck_assert_double_eq(got[2], 2e16 + 3);
    recording_free(&r);
}
END_TEST

/* ---- The suite --------------------------------------------------------------------------------------------------- */

Suite *record_suite(void)
{
    Suite *suite = suite_create("record");
    add_sharing(suite);
    TCase *refusing = add_case(suite, "refusals");
    tcase_add_loop_test(refusing, outputs_are_refused, 0, COUNT(refusals));
    tcase_add_test(refusing, accepted_numbers_are_constants);
    TCase *slots = add_case(suite, "slots");
    tcase_add_test(slots, nesting_is_free);
    tcase_add_test(slots, slots_take_numbers);
    TCase *sums = add_case(suite, "sums");
    tcase_add_test(sums, long_sums_are_right);
    tcase_add_test(sums, sums_keep_their_order);
    return suite;
}
