/* test_chains.c - Tests that the sums of weighted rows that curves are made of agree to the bit: those of one member,
 * of several members, of series and of products with transposed Jacobians. They are written for different layouts of
 * vectors, but in the same two chains of terms. */
#define CURVE_MEMBERS
#define CURVE_ONE_SET
#include "sums.h"

#include "generating/members.h"
#include "generating/tangents.h"
#include "problems/random.h"
#include "suites.h"

enum { MOST_TERMS = 21, DIRECTIONS = 2, ROW = DIRECTIONS * BATCH_MAX_WIDTH };

static _Alignas(64) double weight[MOST_TERMS], weight_of_each[MOST_TERMS * BATCH_MAX_WIDTH], table[MOST_TERMS * ROW];

/* Terms of both signs and of many sizes: any other order of the terms has other bits. */
static void fill(int width, uint64_t *bits)
{
    for (int j = 0; j < MOST_TERMS; j++) {
        weight[j] = ldexp(number_of(bits) - 0.5, -whole(bits, 8));
        for (int m = 0; m < width; m++) weight_of_each[j * width + m] = weight[j];
        for (int m = 0; m < DIRECTIONS * width; m++) table[j * DIRECTIONS * width + m] = number_of(bits) - 0.5;
    }
}

static void check_same(const char *what, int count, int width, const double a[], const double b[])
{
    for (int m = 0; m < width; m++)
        ck_assert_msg(a[m] == b[m], "%s, %d terms, width %d: number %d is off by %g", what, count, width, m,
                      a[m] - b[m]);
}

START_TEST(sums_of_weighted_rows_have_the_same_bits)
{
    const int width = BATCH_MIN_WIDTH << _i;
    const size_t stride = (size_t)(DIRECTIONS * width);
    _Alignas(64) double one[ROW], other[ROW];
    uint64_t bits = 1;
    for (int round = 0; round < 20; round++)
        for (int count = 1; count <= MOST_TERMS; count++) {
            fill(width, &bits);
            jet_combine_strided_rows(count, weight, 1, width, stride, table, one);
            members_combine_rows(count, weight, 1, width, stride, table, other);
            check_same("members", count, width, other, one);
            memset(other, 0, sizeof other);
            tvi_add_weighted_rows((size_t)count, weight, stride, (size_t)width, table, other);
            check_same("series", count, width, other, one);
            curve_multiply_by_transpose_in_lanes(width, count, DIRECTIONS, weight_of_each, table, other);
            check_same("transposes", count, width, other, one);
        }
}
END_TEST

TCase *tcase_chains(void)
{
    TCase *tests = tcase_create("chains");
    tcase_add_loop_test(tests, sums_of_weighted_rows_have_the_same_bits, 0, 3);
    return tests;
}
