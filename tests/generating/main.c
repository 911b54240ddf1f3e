/* main.c - the generating functions, on systems of every form. CK_RUN_SUITE, CK_RUN_CASE and CK_FORK choose, as in
 * every Check program. */
#include "generating.h"

#include <stddef.h>
#include <stdlib.h>

static Suite *(*const suites[])(void) = {
    suite_methods,
    suite_orders,
    suite_adjoints,
    suite_forms,
    suite_geometry,
    suite_tangent_map,
    suite_statements,
    suite_serves,
    suite_points,
    suite_dense,
    suite_convergence,
    suite_definition,
    suite_states,
    suite_fingerprints,
    suite_references,
    suite_galerkin,
    suite_galerkin_lagrangian,
    suite_galerkin_quad,
};

int main(void)
{
    find_kinds();
    SRunner *runner = srunner_create(NULL);
    for (size_t i = 0; i < sizeof suites / sizeof *suites; i++) srunner_add_suite(runner, suites[i]());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
