/* test_sharing.c - Tests how constants are folded and nodes are shared. Cases of the suite "record". */
#include "record.h"
#include "suites.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(table) ((int)(sizeof table / sizeof table[0]))

/* ---- What is the same -------------------------------------------------------------------------------------------- */

/* row(name, one, other): both are the same node, or the same number, for jets x and y. */
#define SAME(ROW)                                                                                                      \
    ROW(difference_of_equals, jet_sub(x, x), jet_const(0))                                                             \
    ROW(sum_of_equals, jet_add(x, x), jet_mul(2, x))                                                                   \
    ROW(times_one, jet_mul(x, 1), x)                                                                                   \
    ROW(one_times, jet_mul(1, x), x)                                                                                   \
    ROW(times_zero, jet_mul(0, x), jet_const(0))                                                                       \
    ROW(plus_zero, jet_add(x, 0), x)                                                                                   \
    ROW(minus_zero, jet_sub(x, 0), x)                                                                                  \
    ROW(zero_minus, jet_sub(0, x), jet_neg(x))                                                                         \
    ROW(negated_twice, jet_neg(jet_neg(x)), x)                                                                         \
    ROW(over_one, jet_div(x, 1), x)                                                                                    \
    ROW(over_number, jet_div(x, 4), jet_mul(0.25, x))                                                                  \
    ROW(zero_over, jet_div(0, x), jet_const(0))                                                                        \
    ROW(scaled_twice, jet_mul(2, jet_mul(-3, x)), jet_mul(-6, x))                                                      \
    ROW(scaled_back, jet_mul(0.5, jet_add(x, x)), x)                                                                   \
    ROW(multiples_collect, jet_add(jet_mul(2, x), jet_mul(3, x)), jet_mul(5, x))                                       \
    ROW(multiples_cancel, jet_sub(jet_mul(2, x), jet_add(x, x)), jet_const(0))                                         \
    ROW(sums_cancel, jet_sub(jet_add(x, y), jet_add(x, y)), jet_const(0))                                              \
    ROW(sum_again, jet_add(x, jet_mul(2, y)), jet_add(x, jet_mul(2, y)))                                               \
    ROW(affine_again, jet_add(jet_mul(2, x), 3), jet_add(3, jet_mul(2, x)))                                            \
    ROW(terms_cancel, jet_sum((const jet[]){x, y, jet_neg(x), jet_const(0)}, 4), y)                                    \
    ROW(later_terms_cancel, jet_sum((const jet[]){x, y, jet_neg(y)}, 3), x)                                            \
    ROW(later_terms_collect, jet_sum((const jet[]){x, y, x, y}, 4), jet_add(jet_mul(2, x), jet_mul(2, y)))             \
    ROW(all_cancel, jet_sum((const jet[]){x, jet_const(3), jet_neg(x)}, 3), jet_const(3))                              \
    ROW(functions_cancel, jet_sub(jet_exp(x), jet_exp(x)), jet_const(0))                                               \
    ROW(product_again, jet_mul(x, y), jet_mul(x, y))                                                                   \
    ROW(product_commutes, jet_mul(x, y), jet_mul(y, x))                                                                \
    ROW(square_is_product, jet_sqr(x), jet_mul(x, x))                                                                  \
    ROW(quotient_again, jet_div(x, y), jet_div(x, y))                                                                  \
    ROW(power_zero, jet_pow(x, 0), jet_const(1))                                                                       \
    ROW(power_one, jet_pow(x, 1), x)                                                                                   \
    ROW(power_two, jet_pow(x, 2), jet_sqr(x))                                                                          \
    ROW(power_three, jet_pow(x, 3), jet_mul(x, jet_sqr(x)))                                                            \
    ROW(power_four, jet_pow(x, 4), jet_sqr(jet_sqr(x)))                                                                \
    ROW(power_half, jet_pow(x, 0.5), jet_sqrt(x))                                                                      \
    ROW(power_minus_one, jet_pow(x, -1), jet_div(1, x))                                                                \
    ROW(power_again, jet_pow(x, -1.5), jet_pow(x, -1.5))                                                               \
    ROW(sin_again, jet_sin(x), jet_sin(x))                                                                             \
    ROW(tanh_again, jet_tanh(x), jet_tanh(x))                                                                          \
    ROW(int_and_double, jet_mul(2, x), jet_mul(2.0, x))                                                                \
    ROW(float_and_double, jet_mul(0.5f, x), jet_mul(0.5, x))                                                           \
    ROW(constant_and_double, jet_mul(jet_const(2), x), jet_mul(2, x))                                                  \
    ROW(empty_sum, jet_sum(&x, 0), jet_const(0))                                                                       \
    ROW(negative_sum, jet_sum(&x, -1), jet_const(0))                                                                   \
    ROW(empty_dot, jet_dot(&x, &y, 0), jet_const(0))                                                                   \
    ROW(negative_dot, jet_dot(&x, &y, -3), jet_const(0))                                                               \
    ROW(sum_of_one, jet_sum(&x, 1), x)                                                                                 \
    ROW(dot_of_one, jet_dot(&x, &y, 1), jet_mul(x, y))                                                                 \
    ROW(dot_with_numbers, jet_dot((const jet[]){x, jet_const(2)}, (const jet[]){jet_const(0), jet_const(4)}, 2),       \
        jet_const(8))                                                                                                  \
    ROW(numbers_add, jet_add(2, 0.5), jet_const(2.5))                                                                  \
    ROW(numbers_subtract, jet_sub(2, 0.5), jet_const(1.5))                                                             \
    ROW(numbers_multiply, jet_mul(2, -3), jet_const(-6))                                                               \
    ROW(numbers_divide, jet_div(3, 2), jet_const(1.5))                                                                 \
    ROW(numbers_in_functions, jet_exp(jet_neg(jet_sqr(2))), jet_const(exp(-4)))                                        \
    ROW(numbers_in_sums, jet_sum((const jet[]){jet_const(1), jet_const(2)}, 2), jet_const(3))                          \
    ROW(number_to_power, jet_pow(3, 2), jet_const(9))                                                                  \
    ROW(number_to_fraction, jet_pow(4, -1.5), jet_const(0.125))                                                        \
    ROW(negative_to_power, jet_pow(-2, 3), jet_const(-8))                                                              \
    ROW(zero_to_zero, jet_pow(0, 0), jet_const(1))

/* row(name, one, other): these are not the same. */
#define DIFFERENT(ROW)                                                                                                 \
    ROW(inputs, x, y)                                                                                                  \
    ROW(sum_and_difference, jet_add(x, y), jet_sub(x, y))                                                              \
    ROW(coefficients, jet_mul(2, x), jet_mul(3, x))                                                                    \
    ROW(scaled_nodes, jet_mul(2, x), jet_mul(2, y))                                                                    \
    ROW(second_coefficients, jet_add(x, y), jet_add(x, jet_mul(2, y)))                                                 \
    ROW(numbers_added, jet_add(x, 1), jet_add(x, 2))                                                                   \
    ROW(lengths, jet_add(x, jet_mul(2, y)), jet_sum((const jet[]){x, jet_mul(2, y), jet_sin(x)}, 3))                   \
    ROW(quotient_and_inverse, jet_div(x, y), jet_div(y, x))                                                            \
    ROW(divisors, jet_div(x, y), jet_div(x, jet_sin(y)))                                                               \
    ROW(dividends, jet_div(1, x), jet_div(2, x))                                                                       \
    ROW(product_and_square, jet_mul(x, y), jet_mul(x, x))                                                              \
    ROW(second_factors, jet_mul(x, y), jet_mul(x, jet_sin(y)))                                                         \
    ROW(functions, jet_sin(x), jet_cos(x))                                                                             \
    ROW(arguments, jet_exp(x), jet_exp(y))                                                                             \
    ROW(inverses, jet_asin(x), jet_acos(x))                                                                            \
    ROW(exponents, jet_pow(x, 1.5), jet_pow(x, 2.5))                                                                   \
    ROW(not_zero, jet_mul(1e-300, x), jet_const(0))

typedef void pair_fn(jet x, jet y, jet out[2]);

#define PAIR(name, one, other)                                                                                         \
    static void name(jet x, jet y, jet out[2])                                                                         \
    {                                                                                                                  \
        (void)x, (void)y;                                                                                              \
        out[0] = one;                                                                                                  \
        out[1] = other;                                                                                                \
    }
SAME(PAIR)
DIFFERENT(PAIR)

#define NAMED(name, one, other) {#name, name},
static const struct {
    const char *name;
    pair_fn *build;
} same[] = {SAME(NAMED)}, different[] = {DIFFERENT(NAMED)};

static bool equal(const jet pair[2])
{
    return pair[0].node == pair[1].node && (pair[0].node || pair[0].number == pair[1].number);
}

/* Builds the pair over two inputs, or over two computed jets, which have no fixed place in the graph. */
static bool build_equal(pair_fn *build, bool computed)
{
    jet_graph *graph = jet_graph_create(2);
    const jet x = jet_graph_input(graph, 0), y = jet_graph_input(graph, 1);
    jet pair[2];
    if (computed) build(jet_mul(x, y), jet_cosh(x), pair);
    else build(x, y, pair);
    const bool result = equal(pair);
    ck_assert_int_eq(jet_graph_check_outputs(graph, 2, pair), TVI_OK);
    jet_graph_free(graph);
    return result;
}

START_TEST(same_is_shared)
{
    ck_assert_msg(build_equal(same[_i].build, false), "%s of inputs", same[_i].name);
    ck_assert_msg(build_equal(same[_i].build, true), "%s of computed jets", same[_i].name);
}
END_TEST

START_TEST(different_is_kept)
{
    ck_assert_msg(!build_equal(different[_i].build, false), "%s of inputs", different[_i].name);
    ck_assert_msg(!build_equal(different[_i].build, true), "%s of computed jets", different[_i].name);
}
END_TEST

/* The first recorded node is found again after thousands of nodes that differ in their numbers alone, and soon: in a
 * table at most half full a search meets less than one other node on the average, and a node is looked for when it is
 * recorded, again, and when the table grows. */
START_TEST(sharing_survives_growth)
{
    enum { MANY = 50000 };
    static jet first[MANY];
    jet_graph *graph = jet_graph_create(1);
    const jet x = jet_graph_input(graph, 0);
    for (int i = 0; i < MANY; i++) first[i] = jet_pow(x, 0.25 + i);
    ck_assert_int_eq(jet_graph_node_count(graph), 1 + MANY);
    for (int i = 0; i < MANY; i++) ck_assert_ptr_eq(jet_pow(x, 0.25 + i).node, first[i].node);
    ck_assert_int_eq(jet_graph_node_count(graph), 1 + MANY);
    for (int i = 0; i < MANY; i++) ck_assert_int_eq(jet_graph_node_at(graph, 1 + i)->index, 1 + i);
    ck_assert_int_lt(jet_graph_hash_collision_count(graph), 2 * jet_graph_node_count(graph));
    jet_graph_free(graph);
}
END_TEST

/* Sums of which one begins like the other are different: k terms, k = 1 .. MANY, of which one is an input. */
START_TEST(beginnings_are_different)
{
    enum { MANY = 500 };
    jet_graph *graph = jet_graph_create(MANY);
    jet in[MANY];
    for (int i = 0; i < MANY; i++) in[i] = jet_graph_input(graph, i);
    for (int k = 1; k <= MANY; k++) {
        const jet sum = jet_sum(in, k);
        ck_assert_int_eq(jet_graph_node_count(graph), MANY + k - 1);
        ck_assert_int_eq(sum.node->count, k == 1 ? 0 : k);
        ck_assert_ptr_eq(jet_sum(in, k).node, sum.node);
    }
    jet_graph_free(graph);
}
END_TEST

/* ---- Counts of nodes --------------------------------------------------------------------------------------------- */

/* row(name, nodes, result): so many nodes are added to the two inputs, auxiliary nodes among them. */
#define COUNTS(ROW)                                                                                                    \
    ROW(of_numbers, 0, jet_sub(jet_tanh(jet_add(1, jet_exp(0.5))), jet_div(jet_pow(2, 0.5), jet_log(3))))              \
    ROW(of_nothing, 0, jet_mul(0, x))                                                                                  \
    ROW(of_addition, 1, jet_add(x, y))                                                                                 \
    ROW(of_affine, 2, jet_add(jet_mul(2, x), 3))                                                                       \
    ROW(of_long_sum, 1, jet_sum((const jet[]){x, y, x, y, jet_const(2)}, 5))                                           \
    ROW(of_dot, 3, jet_dot((const jet[]){x, x}, (const jet[]){x, y}, 2))                                               \
    ROW(of_equal_products, 2, jet_add(jet_mul(x, y), jet_mul(y, x)))                                                   \
    ROW(of_reciprocal, 2, jet_div(1, x))                                                                               \
    ROW(of_root, 1, jet_sqrt(x))                                                                                       \
    ROW(of_power, 1, jet_pow(x, -1.5))                                                                                 \
    ROW(of_eighth_power, 3, jet_pow(x, 8))                                                                             \
    ROW(of_seventh_power, 4, jet_pow(x, 7))                                                                            \
    ROW(of_exp, 1, jet_exp(x))                                                                                         \
    ROW(of_log, 1, jet_log(x))                                                                                         \
    ROW(of_sin, 2, jet_sin(x))                                                                                         \
    ROW(of_sin_and_cos, 3, jet_mul(jet_sin(x), jet_cos(x)))                                                            \
    ROW(of_sinh_and_cosh, 3, jet_mul(jet_cosh(x), jet_sinh(x)))                                                        \
    ROW(of_tan, 3, jet_tan(x))                                                                                         \
    ROW(of_tanh, 2, jet_tanh(x))                                                                                       \
    ROW(of_atan, 3, jet_atan(x))                                                                                       \
    ROW(of_asin, 5, jet_asin(x))                                                                                       \
    ROW(of_asin_and_acos, 7, jet_mul(jet_asin(x), jet_acos(x)))

#define SINGLE(name, nodes, result)                                                                                    \
    static jet count_##name(jet x, jet y) { return (void)x, (void)y, result; }
COUNTS(SINGLE)

#define COUNTED(name, nodes, result) {#name, count_##name, nodes},
static const struct {
    const char *name;
    jet (*build)(jet x, jet y);
    int nodes;
} counts[] = {COUNTS(COUNTED)};

START_TEST(nodes_are_few)
{
    jet_graph *graph = jet_graph_create(2);
    ck_assert_int_eq(jet_graph_input_count(graph), 2);
    ck_assert_int_eq(jet_graph_node_count(graph), 2);
    (void)counts[_i].build(jet_graph_input(graph, 0), jet_graph_input(graph, 1));
    ck_assert_msg(jet_graph_node_count(graph) == 2 + counts[_i].nodes, "%d nodes %s instead of %d",
                  jet_graph_node_count(graph) - 2, counts[_i].name, counts[_i].nodes);
    jet_graph_free(graph);
}
END_TEST

/* Not one byte of a closed recording changes, whatever is tried with its jets. */
START_TEST(closed_recording_is_not_written)
{
    jet_graph *graph = jet_graph_create(2);
    const jet x = jet_graph_input(graph, 0), y = jet_graph_input(graph, 1), u = jet_sin(jet_add(x, jet_mul(3, y)));
    jet_graph_end_recording(graph);
    enum { MOST = 16 };
    struct jet_node before[MOST];
    const int count = jet_graph_node_count(graph);
    ck_assert_int_le(count, MOST);
    for (int i = 0; i < count; i++) before[i] = *jet_graph_node_at(graph, i);
    jet gradient[2];
    for (int i = 0; i < COUNT(same); i++)
        same[i].build(x, u, (jet[2]){jet_make_unset_poison(), jet_make_unset_poison()});
    for (int i = 0; i < COUNT(different); i++)
        different[i].build(y, u, (jet[2]){jet_make_unset_poison(), jet_make_unset_poison()});
    ck_assert(jet_record_gradient(graph, u, 2, gradient));
    ck_assert_int_eq(jet_graph_check_outputs(graph, 1, gradient), TVI_EINVAL);
    ck_assert_int_eq(jet_graph_node_count(graph), count);
    const size_t bytes =
        offsetof(struct jet_node, parameter_index) + sizeof before->parameter_index; /* what follows is not set */
    for (int i = 0; i < count; i++) ck_assert_mem_eq(&before[i], jet_graph_node_at(graph, i), bytes);
    jet_graph_free(graph);
}
END_TEST

void add_sharing(Suite *suite)
{
    TCase *sharing = add_case(suite, "sharing");
    tcase_add_loop_test(sharing, same_is_shared, 0, COUNT(same));
    tcase_add_loop_test(sharing, different_is_kept, 0, COUNT(different));
    tcase_add_loop_test(sharing, nodes_are_few, 0, COUNT(counts));
    tcase_add_test(sharing, sharing_survives_growth);
    tcase_add_test(sharing, beginnings_are_different);
    tcase_add_test(sharing, closed_recording_is_not_written);
}
