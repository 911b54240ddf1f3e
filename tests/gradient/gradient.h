/* gradient.h - Declares the suite of gradients, and the systems of all forms that it goes back through. */
#ifndef TESTS_GRADIENT_GRADIENT_H
#define TESTS_GRADIENT_GRADIENT_H

#include "columns.h"

Suite *suite_gradient(void), *suite_integrals(void), *suite_chaos(void);
TCase *tcase_exact(void), *tcase_sequences(void), *tcase_second(void);

/* The systems of columns.h, and then a double pendulum, a driven Lagrangian, a force that depends on the time, and
 * Kepler's problem in steps of K. */
const columns_problem *gradient_problem(int i);
enum { GRADIENT_DOUBLE_PENDULUM = COLUMNS_PROBLEMS, GRADIENT_DRIVEN_LAGRANGIAN, GRADIENT_TIME, GRADIENT_K };
enum { GRADIENT_PROBLEMS = GRADIENT_K + 1 };

/* columns_open, with a record. */
void gradient_open(columns_run *run, int problem, const char *method, int order);

/* The derivative of value(x), x = 0, by a central difference with an error of d^8, and of roundoff / d. */
typedef long double gradient_value(long double x, void *ctx);
long double gradient_slope(gradient_value *value, void *ctx, long double d);

/* What a run begins with. */
typedef struct {
    double t, q[COLUMNS_MOST_N], p[COLUMNS_MOST_N], c[COLUMNS_MOST_PARAMETERS];
} gradient_start;
/* The start of an open run, at another time than 0. */
gradient_start gradient_start_of(const columns_run *run);
/* Begins with x: the run's parameters become those of x, and this returns a copy, for t, q and p to move. */
gradient_start gradient_begin(const columns_run *run, const gradient_start *x);
typedef double gradient_loss(const gradient_start *x, void *ctx);
/* Computes the gradient of that start by the run's record, and ends the test where it is not what differences say. */
void gradient_expect(const columns_run *run, const tvi_loss *by, gradient_loss *loss, void *ctx);

#endif
