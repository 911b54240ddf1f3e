/* run_suites.h - what a test program does: all its suites. CK_RUN_SUITE, CK_RUN_CASE and CK_FORK choose, as in every
 * Check program. */
#ifndef TESTS_PROBLEMS_RUN_SUITES_H
#define TESTS_PROBLEMS_RUN_SUITES_H

#include <check.h>
#include <stddef.h>
#include <stdlib.h>

static inline int run_suites(size_t count, Suite *(*const suites[])(void))
{
    SRunner *all = srunner_create(NULL);
    for (size_t i = 0; i < count; i++) srunner_add_suite(all, suites[i]());
    srunner_run_all(all, CK_ENV);
    const int failed = srunner_ntests_failed(all);
    srunner_free(all);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* Of an array of them. */
#define RUN_SUITES(suites) run_suites(sizeof(suites) / sizeof *(suites), suites)

#endif
