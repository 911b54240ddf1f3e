/* sampled.c - Bounds the time of a test program that is linked with --wrap=_tcase_add_test. If the environment has
 * TESTS_EVERY = k, a loop test runs its first row and about one in k of the others. A hash of the row chooses them, so
 * that no period of the rows, which are often products of models and methods, meets that of the choice. */
#include <check.h>
#include <stdint.h>
#include <stdlib.h>

void __real__tcase_add_test(TCase *tests, const TTest *test, int signal, int status, int start, int end);
void __wrap__tcase_add_test(TCase *tests, const TTest *test, int signal, int status, int start, int end);

static uint64_t hash(uint64_t row)
{
    const uint64_t mixed = row * 0x9e3779b97f4a7c15u;
    return (mixed ^ mixed >> 32) * 0xd6e8feb86659fd93u >> 32;
}

void __wrap__tcase_add_test(TCase *tests, const TTest *test, int signal, int status, int start, int end)
{
    const char *asked = getenv("TESTS_EVERY");
    const uint64_t every = asked ? strtoul(asked, NULL, 10) : 1;
    if (every <= 1) {
        __real__tcase_add_test(tests, test, signal, status, start, end);
        return;
    }
    for (int row = start; row < end; row++)
        if (row == start || hash((uint64_t)row) % every == 0)
            __real__tcase_add_test(tests, test, signal, status, row, row + 1);
}
