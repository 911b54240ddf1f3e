/* run_suites.h - Declares what a test program does: all its suites. CK_RUN_SUITE, CK_RUN_CASE and CK_FORK choose, as in
 * every Check program. */
#ifndef TESTS_PROBLEMS_RUN_SUITES_H
#define TESTS_PROBLEMS_RUN_SUITES_H

#include <check.h>
#include <stddef.h>
#include <stdlib.h>

/* Seconds for one test, which ends what hangs. The longest test of make check takes 7 s alone on one core of 2026, and
 * that of check-thorough was seen to take 75 s with three others beside it. */
#define RUN_SUITES_TIMEOUT "600"

static inline int run_suites(size_t count, Suite *(*const suites[])(void))
{
    setenv("CK_DEFAULT_TIMEOUT", RUN_SUITES_TIMEOUT, 0);
    SRunner *all = srunner_create(NULL);
    for (size_t i = 0; i < count; i++) srunner_add_suite(all, suites[i]());
    srunner_run_all(all, CK_ENV);
    const int failed = srunner_ntests_failed(all);
    srunner_free(all);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* Runs an array of suites. */
#define RUN_SUITES(suites) run_suites(sizeof(suites) / sizeof *(suites), suites)

#endif
