/* main.c - Runs the suites on ensembles. */
#include "ensemble.h"
#include "problems/run_suites.h"

static Suite *(*const suites[])(void) = {suite_bits,  suite_runs,    suite_failing, suite_states,
                                         suite_texts, suite_refused, suite_members, suite_walks};

int main(void) { return RUN_SUITES(suites); }
