/* main.c - Runs the suites on parameters. */
#include "parameters.h"
#include "problems/run_suites.h"

static Suite *(*const suites[])(void) = {suite_values, suite_sensitivities, suite_refused};

int main(void) { return RUN_SUITES(suites); }
