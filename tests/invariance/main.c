/* main.c - the same motion in other coordinates, other units, other order, and back. CK_RUN_SUITE, CK_RUN_CASE and
 * CK_FORK choose, as in every Check program. */
#include "invariance.h"

#include <stdlib.h>

int main(void)
{
    SRunner *runner = srunner_create(suite_frames());
    srunner_add_suite(runner, suite_reversed());
    srunner_add_suite(runner, suite_numbers());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
