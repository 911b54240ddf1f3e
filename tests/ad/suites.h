/* suites.h - Declares the suites of the jets layer, one a file. */
#ifndef TVI_TESTS_AD_SUITES_H
#define TVI_TESTS_AD_SUITES_H

#include <check.h>

Suite *record_suite(void);
Suite *domain_suite(void);
Suite *tape_suite(void);
Suite *series_suite(void);
Suite *scales_suite(void);
Suite *identity_suite(void);
Suite *tangent_suite(void);
Suite *adjoint_suite(void);
Suite *isa_suite(void);
Suite *roots_suite(void);
Suite *elementary_suite(void);
Suite *gradient_suite(void);
Suite *hash_suite(void);
Suite *emit_suite(void);

/* Cases of the suites "record", "tape" and "emit" that have files of their own. */
void add_sharing(Suite *suite);
void add_runs(Suite *suite);
void add_splits(Suite *suite);
void add_bodies(Suite *suite);

/* An empty case of the suite. */
static inline TCase *add_case(Suite *suite, const char *name)
{
    TCase *tests = tcase_create(name);
    suite_add_tcase(suite, tests);
    return tests;
}

#endif
