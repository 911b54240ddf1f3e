/* main.c - steps that adapt. CK_RUN_SUITE, CK_RUN_CASE and CK_FORK choose, as in every Check program. */
#include "rescaled.h"

#include <stdlib.h>

int main(void)
{
    SRunner *runner = srunner_create(NULL);
    srunner_add_suite(runner, suite_scale());
    srunner_add_suite(runner, suite_structure());
    srunner_add_suite(runner, suite_orders());
    srunner_add_suite(runner, suite_times());
    srunner_add_suite(runner, suite_tangent());
    srunner_add_suite(runner, suite_refused());
    srunner_add_suite(runner, suite_scenes());
    srunner_add_suite(runner, suite_passes());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
