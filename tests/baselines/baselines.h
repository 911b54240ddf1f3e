/* baselines.h - Declares what the suites of bench/baselines share. */
#ifndef TESTS_BASELINES_H
#define TESTS_BASELINES_H

#include "baselines/baseline.h"
#include "problems/problems.h"

#include <check.h>

Suite *suite_orders(void);
Suite *suite_structure(void);
Suite *suite_forces(void);
Suite *suite_galerkin(void);

/* The problems of tests/problems/problems.h with a plain force, and two more: the Fermi-Pasta-Ulam chain and the Solar
 * System, whose masses differ; t_end is short. */
enum { BASELINE_PROBLEMS = 5 };
extern const test_problem *const baseline_problems[BASELINE_PROBLEMS];

/* The state at t = h steps from the problem's start. */
tvi_status baseline_run(const baseline *b, const test_problem *problem, double h, long steps, test_state *state);

#endif
