/* main.c - friction and drives. CK_RUN_SUITE, CK_RUN_CASE and CK_FORK choose, as in every Check program. */
#include "driven.h"

#include <stdlib.h>

int main(void)
{
    SRunner *runner = srunner_create(suite_motion());
    srunner_add_suite(runner, suite_balance());
    srunner_add_suite(runner, suite_refused());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
