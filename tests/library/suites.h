/* suites.h - Declares the suites that main.c runs. */
#ifndef TESTS_SUITES_H
#define TESTS_SUITES_H

#include <check.h>

Suite *suite_closed_forms(void);
Suite *suite_structure(void);
Suite *suite_stepping(void);
Suite *suite_tail(void);
Suite *suite_products(void);
Suite *suite_sums(void);
TCase *tcase_chains(void); /* a case of it */
Suite *suite_linear(void);
Suite *suite_arena(void);
Suite *suite_passes(void);
Suite *suite_quad(void); /* gcc only: __float128 */
Suite *suite_input(void);
Suite *suite_faults(void);

#endif
