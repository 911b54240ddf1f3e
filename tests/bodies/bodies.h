/* bodies.h - Declares the suites of tvi_bodies.h. */
#ifndef TESTS_BODIES_H
#define TESTS_BODIES_H

#include "tvi_bodies.h"

#include <check.h>

Suite *suite_orbits(void);
Suite *suite_elements(void);
Suite *suite_places(void);
Suite *suite_attraction(void);
Suite *suite_refused(void);
Suite *suite_sums(void);
Suite *suite_scales(void);
Suite *suite_defect(void);

#endif
