/* driven.h - Declares what the suites of driven systems share: an oscillator with friction and a drive, which has a
 * closed form, in every form of a system. */
#ifndef TESTS_DRIVEN_H
#define TESTS_DRIVEN_H

#include "tvi.h"

#include <check.h>

Suite *suite_motion(void);
Suite *suite_balance(void);
Suite *suite_refused(void);

/* y'' = -y - 2 c y' + A cos(w t): in y as a potential; in x, y = sinh x, as a Hamiltonian and as a Lagrangian. */
typedef struct {
    const char *name;
    tvi_status (*make)(tvi_system **base);
    tvi_drive_fn *drive;
    int bends; /* it is in x */
} form;
extern const form forms[];
enum { FORMS = 3 };
static const double FRICTION = 0.0625, AMPLITUDE = 0.75, OMEGA = 1.75;

/* Ends the test where it fails. */
tvi_system *system_of(const form *as);
tvi_integrator *integrator_of(const tvi_system *system, const char *method, int order);

/* y and y' at t, from (1, 0) at t = 0; [column]: their derivatives by y and y' at the start. */
typedef struct {
    double y, rate, by_start[2][2];
} motion;
motion exact(double t);

/* Between (y, y') and what the form has. */
void to_form(const form *as, double y, double rate, double *q, double *p);
void from_form(const form *as, double q, double p, double *y, double *rate);

#endif
