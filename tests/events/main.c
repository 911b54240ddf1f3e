/* main.c - Runs the suites on events, results at given times, runs to a tolerance, and the bar. */
#include "events.h"
#include "problems/run_suites.h"

static Suite *(*const suites[])(void) = {
    suite_events,          suite_search,    suite_starts,         suite_roots,
    suite_observers,       suite_cuts,      suite_plans,          suite_columns,
    suite_times,           suite_tolerance, suite_tolerance_runs, suite_tolerance_far,
    suite_tolerance_zeros, suite_progress,  suite_suggest,        suite_suggest_eccentric,
    suite_suggest_roundoff};

int main(void) { return RUN_SUITES(suites); }
