/* rigid.h - Declares what the suites of rigid bodies share. */
#ifndef TESTS_RIGID_H
#define TESTS_RIGID_H

#include "tvi_rigid.h"

#include <check.h>

/* A run: the system, its integrator and its state. */
typedef struct {
    const tvi_rigid *r;
    tvi_system *system;
    tvi_integrator *integrator;
    double t, q[36], p[36];
} rigid_run;

/* Each of these ends the test if it fails. NULL options are those of the library. */
rigid_run rigid_begin(const tvi_rigid *r, const tvi_rigid_motion motion[], const tvi_options *options);
void rigid_go_on(rigid_run *run, double h, long steps, tvi_observer *observer, void *ctx);
tvi_rigid_motion rigid_motion_of(const rigid_run *run, int body);
double rigid_energy_of(const rigid_run *run);
void rigid_end(rigid_run *run);

/* Turns X by a quaternion of any length. */
void turn_by(const double quaternion[4], const double X[3], double x[3]);

static inline void expect_close(const char *what, double is, double wanted, double within)
{
    const double error = is > wanted ? is - wanted : wanted - is;
    ck_assert_msg(error <= within, "%s: %.17g, not %.17g: off by %.1e, not %.1e", what, is, wanted, error, within);
}

#endif
