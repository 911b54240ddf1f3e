/* parameters.h - Declares what the suites of parameters share: one problem in every form, as a recording with
 * parameters and as one with the numbers themselves. */
#ifndef TESTS_PARAMETERS_H
#define TESTS_PARAMETERS_H

#include "tvi.h"

#include <check.h>

Suite *suite_values(void);
Suite *suite_sensitivities(void);
Suite *suite_refused(void);

enum { N = 2, PARAMETERS = 2 };

/* The numbers that are recorded, and those that are set. */
static const double recorded[PARAMETERS] = {1, 0.25}, other[PARAMETERS] = {1.25, -0.5};

/* V = r^4 / 8 - k / r + m x^2 y, with k and m as parameters 0 and 1 of the recorded values, or numbers[] in their
 * place. */
typedef struct {
    const char *name;
    tvi_status (*make)(tvi_system **system, const double *numbers);
} form;
extern const form forms[];
enum { FORMS = 4 };

/* Ends the test where it fails. numbers NULL: with parameters. */
tvi_system *system_of(const form *as, const double *numbers);

typedef struct {
    const char *name;
    int order;
} method;
extern const method methods[];
enum { METHODS = 8 };

typedef struct {
    double t, q[N], p[N];
} state;
static const state start = {0, {1, 0}, {0.125, 1}};

/* The form serves the method; else the row is empty. */
tvi_integrator *integrator_of(const tvi_system *system, const method *by);
/* Steps from `start` that must succeed. */
state run(tvi_integrator *integrator, int steps);
static const double H = 0.05;

double distance(const state *a, const state *b);

#endif
