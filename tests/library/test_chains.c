/* test_chains.c - Tests that the two functions that sum weighted rows of curves agree to the bit: that of combinations
 * and that of series. They are written for different layouts of vectors, but in the same two chains of terms. */
#include "sums.h"

#include "generating/curve.h"
#include "problems/random.h"
#include "suites.h"

enum { MOST_TERMS = 21, MOST_WIDTH = 32 };

static _Alignas(64) double weight[MOST_TERMS], table[MOST_TERMS * MOST_WIDTH];

/* Terms of both signs and of many sizes: any other order of the terms has other bits. */
static void fill(uint64_t *bits)
{
    for (int j = 0; j < MOST_TERMS; j++) weight[j] = ldexp(number_of(bits) - 0.5, -whole(bits, 8));
    for (int k = 0; k < MOST_TERMS * MOST_WIDTH; k++) table[k] = number_of(bits) - 0.5;
}

START_TEST(sums_of_weighted_rows_have_the_same_bits)
{
    const int width = 8 << _i;
    _Alignas(64) double one[MOST_WIDTH], other[MOST_WIDTH];
    uint64_t bits = 1;
    for (int round = 0; round < 20; round++)
        for (int count = 1; count <= MOST_TERMS; count++) {
            fill(&bits);
            jet_combine_strided_rows(count, weight, 1, width, MOST_WIDTH, table, one);
            memset(other, 0, sizeof other);
            tvi_add_weighted_rows((size_t)count, weight, MOST_WIDTH, (size_t)width, table, other);
            for (int m = 0; m < width; m++)
                ck_assert_msg(other[m] == one[m], "%d terms, width %d: number %d is off by %g", count, width, m,
                              other[m] - one[m]);
        }
}
END_TEST

TCase *tcase_chains(void)
{
    TCase *tests = tcase_create("chains");
    tcase_add_loop_test(tests, sums_of_weighted_rows_have_the_same_bits, 0, 3);
    return tests;
}
