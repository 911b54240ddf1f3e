/* main.c - runs the suites of the library. CK_RUN_SUITE, CK_RUN_CASE and CK_FORK choose, as in every Check program.
 * TESTS_WITHOUT_QUAD leaves out what needs quadruple precision, which only gcc compiles. */
#include "suites.h"

#include <stddef.h>
#include <stdlib.h>

static Suite *(*const suites[])(void) = {
    suite_input, suite_faults,   suite_closed_forms, suite_order, suite_structure, suite_stepping,
    suite_tail,  suite_products, suite_linear,       suite_arena, suite_passes,
#ifndef TESTS_WITHOUT_QUAD
    suite_quad,
#endif
};

int main(void)
{
    SRunner *runner = srunner_create(NULL);
    for (size_t i = 0; i < sizeof suites / sizeof *suites; i++) srunner_add_suite(runner, suites[i]());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
