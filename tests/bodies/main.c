/* main.c - Runs the suites on bodies that attract each other, and orbital elements. */
#include "bodies.h"
#include "problems/run_suites.h"

static Suite *(*const suites[])(void) = {suite_orbits,  suite_elements, suite_places, suite_attraction,
                                         suite_refused, suite_sums,     suite_scales, suite_defect};

int main(void) { return RUN_SUITES(suites); }
