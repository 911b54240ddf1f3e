/* main.c - Runs the suites of the library.
 * TESTS_WITHOUT_QUAD leaves out what needs quadruple precision, which only gcc compiles. */
#include "suites.h"
#include "problems/run_suites.h"

static Suite *(*const suites[])(void) = {
    suite_input,    suite_faults, suite_closed_forms, suite_structure, suite_stepping, suite_tail,
    suite_products, suite_sums,   suite_linear,       suite_arena,     suite_passes,
#ifndef TESTS_WITHOUT_QUAD
    suite_quad,
#endif
};

int main(void) { return RUN_SUITES(suites); }
