/* main.c - runs the suites of the jets layer; what is printed, and whether tests fork, is for Check's environment. */
#include "suites.h"

#include <stdlib.h>

int main(void)
{
    SRunner *runner = srunner_create(record_suite());
    srunner_add_suite(runner, domain_suite());
    srunner_add_suite(runner, tape_suite());
    srunner_add_suite(runner, series_suite());
    srunner_add_suite(runner, identity_suite());
    srunner_add_suite(runner, tangent_suite());
    srunner_add_suite(runner, adjoint_suite());
    srunner_add_suite(runner, isa_suite());
    srunner_add_suite(runner, gradient_suite());
    srunner_add_suite(runner, hash_suite());
    srunner_add_suite(runner, emit_suite());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
