/* main.c - Runs the suites on derivatives of whole runs. */
#include "gradient.h"
#include "problems/run_suites.h"

static Suite *(*const suites[])(void) = {suite_chaos, suite_columns, suite_gradient, suite_integrals};

int main(void) { return RUN_SUITES(suites); }
