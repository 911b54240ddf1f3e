/* events.h - Declares the suites of this program. */
#ifndef TESTS_EVENTS_H
#define TESTS_EVENTS_H

#include <check.h>

Suite *suite_events(void);
Suite *suite_search(void);
Suite *suite_starts(void);
Suite *suite_roots(void);
Suite *suite_observers(void);
Suite *suite_cuts(void);
Suite *suite_plans(void);
Suite *suite_columns(void);
Suite *suite_times(void);
Suite *suite_tolerance(void);
Suite *suite_tolerance_runs(void);
Suite *suite_tolerance_far(void);
Suite *suite_tolerance_zeros(void);
Suite *suite_progress(void);
Suite *suite_suggest(void);
Suite *suite_suggest_eccentric(void);
Suite *suite_suggest_roundoff(void);
void add_refusals(TCase *tcase); /* to the suite of events */

#endif
