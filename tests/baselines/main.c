/* main.c - the baselines of the bench. CK_RUN_SUITE, CK_RUN_CASE and CK_FORK choose, as in every Check program. */
#include "baselines.h"

#include <stddef.h>
#include <stdlib.h>

static Suite *(*const suites[])(void) = {
    suite_forces,
    suite_orders,
    suite_structure,
    suite_galerkin,
};

int main(void)
{
    SRunner *all = srunner_create(NULL);
    for (size_t i = 0; i < sizeof suites / sizeof *suites; i++) srunner_add_suite(all, suites[i]());
    srunner_run_all(all, CK_ENV);
    const int failed = srunner_ntests_failed(all);
    srunner_free(all);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
