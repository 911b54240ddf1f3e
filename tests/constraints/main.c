/* main.c - Runs the suites on constraints. */
#include "constraints.h"
#include "problems/run_suites.h"

static Suite *(*const suites[])(void) = {suite_statement,   suite_states,       suite_starts,   suite_work,
                                         suite_steps,       suite_runs,         suite_joints,   suite_rigid,
                                         suite_linkages,    suite_wrong_bodies, suite_compiled, suite_spark_quad,
                                         suite_andrews_quad};

int main(void) { return RUN_SUITES(suites); }
