/* main.c - Runs the suites on friction and drives. */
#include "driven.h"
#include "problems/run_suites.h"

static Suite *(*const suites[])(void) = {suite_motion, suite_balance, suite_refused};

int main(void) { return RUN_SUITES(suites); }
