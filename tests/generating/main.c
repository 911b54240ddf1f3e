/* main.c - Runs the suites on the generating functions, on systems of every form. */
#include "generating.h"
#include "problems/run_suites.h"

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
    return RUN_SUITES(suites);
}
