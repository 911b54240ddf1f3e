/* stepping.h - Declares what the tests of steps share: problems, and a run from the start of one. */
#ifndef TVI_TESTS_STEPPING_H
#define TVI_TESTS_STEPPING_H

#include "problems/problems.h"

#include <check.h>

enum { STEP_PROBLEMS = 4 };
extern const test_problem *const step_problems[STEP_PROBLEMS];

tvi_options on_curve(tvi_expansion expansion, int degree); /* of type I */
/* The state after steps of size h from the start of the problem, and the counts, where stats is not NULL. */
test_state run_from_start(const test_problem *problem, const tvi_options *options, double h, long steps,
                          tvi_stats *stats);
bool same_bits(const test_state *a, const test_state *b);

TCase *tcase_sequences(void); /* in stepping_sequences.c */

#endif
