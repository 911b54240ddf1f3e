/* main.c - Runs the suites on the baselines of the bench. */
#include "baselines.h"
#include "problems/run_suites.h"

static Suite *(*const suites[])(void) = {
    suite_forces,
    suite_orders,
    suite_structure,
    suite_galerkin,
};

int main(void) { return RUN_SUITES(suites); }
