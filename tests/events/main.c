/* main.c - events, results at given times, runs to a tolerance, and the bar. CK_RUN_SUITE, CK_RUN_CASE and CK_FORK
 * choose, as in every Check program. */
#include "events.h"

#include <stddef.h>
#include <stdlib.h>

static Suite *(*const suites[])(void) = {suite_events,    suite_search,         suite_times,
                                         suite_tolerance, suite_tolerance_runs, suite_progress};

int main(void)
{
    SRunner *runner = srunner_create(NULL);
    for (size_t i = 0; i < sizeof suites / sizeof *suites; i++) srunner_add_suite(runner, suites[i]());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
