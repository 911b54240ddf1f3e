/* generating.h - Declares the suites of this program. */
#ifndef TESTS_GENERATING_H
#define TESTS_GENERATING_H

#include <check.h>

void find_kinds(void); /* of models.h: before the suites are made */

Suite *suite_methods(void);
Suite *suite_orders(void);
Suite *suite_adjoints(void);
Suite *suite_forms(void);
Suite *suite_geometry(void);
Suite *suite_tangent_map(void);
Suite *suite_statements(void);
Suite *suite_serves(void);
Suite *suite_points(void);
Suite *suite_dense(void);
Suite *suite_convergence(void);
Suite *suite_definition(void);
Suite *suite_states(void);
Suite *suite_fingerprints(void);
Suite *suite_references(void); /* gcc only: __float128 */
Suite *suite_galerkin(void);
void add_galerkin_passes(Suite *suite); /* a case of it */
Suite *suite_galerkin_lagrangian(void);
Suite *suite_galerkin_quad(void); /* likewise */

#endif
