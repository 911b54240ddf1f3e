/* gradient.h - Declares the suite of gradients, and the systems of all forms that it goes back through. */
#ifndef TESTS_GRADIENT_GRADIENT_H
#define TESTS_GRADIENT_GRADIENT_H

#include "columns.h"

Suite *suite_gradient(void), *suite_integrals(void), *suite_chaos(void);
TCase *tcase_exact(void), *tcase_sequences(void);

/* The systems of columns.h, and then a double pendulum, a driven Lagrangian, a force that depends on the time, and
 * Kepler's problem in steps of K. */
const columns_problem *gradient_problem(int i);
enum { GRADIENT_DOUBLE_PENDULUM = COLUMNS_PROBLEMS, GRADIENT_DRIVEN_LAGRANGIAN, GRADIENT_TIME, GRADIENT_K };
enum { GRADIENT_PROBLEMS = GRADIENT_K + 1 };

#endif
