/* invariance.h - Declares the suites of this program. */
#ifndef TESTS_INVARIANCE_H
#define TESTS_INVARIANCE_H

#include <check.h>

Suite *suite_frames(void);
Suite *suite_reversed(void);
Suite *suite_numbers(void);
Suite *suite_subsystems(void);
Suite *suite_light(void);
Suite *suite_probe(void);
Suite *suite_sizes(void);
Suite *suite_rounding(void);
Suite *suite_unguarded(void);

#endif
