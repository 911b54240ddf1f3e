/* main.c - Runs the suites on steps that adapt. */
#include "rescaled.h"
#include "problems/run_suites.h"

static Suite *(*const suites[])(void) = {suite_scale,  suite_automatic, suite_structure, suite_orders,
                                         suite_times,  suite_tangent,   suite_refused,   suite_scenes,
                                         suite_passes, suite_reversible};

int main(void) { return RUN_SUITES(suites); }
