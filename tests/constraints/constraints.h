/* constraints.h - Declares what the suites of constraints share: constrained systems in every form. */
#ifndef TESTS_CONSTRAINTS_H
#define TESTS_CONSTRAINTS_H

#include "tvi.h"

#include <check.h>

Suite *suite_statement(void);
Suite *suite_states(void);
Suite *suite_starts(void);
Suite *suite_work(void);
Suite *suite_steps(void);
Suite *suite_runs(void);
Suite *suite_joints(void);
Suite *suite_rigid(void);
Suite *suite_linkages(void);
Suite *suite_wrong_bodies(void);
Suite *suite_compiled(void);
Suite *suite_spark_quad(void); /* gcc only: __float128 */
Suite *suite_andrews_quad(void);

enum { MOST_N = 4, MOST_M = 2 };

/* A system, its constraints, and a state within a hundredth or so of them. */
typedef struct {
    const char *name;
    int n, m;
    tvi_status (*make)(tvi_system **base);
    tvi_constraint_fn *phi;
    double t, q[MOST_N], p[MOST_N];
    /* Adds the forces that no energy gives to force [n]; NULL: there are none. */
    void (*add_force)(double t, const double q[], const double v[], double force[]);
    int has_energy;
} problem;
extern const problem problems[];
extern const int problem_count;

/* The indices of some of them. */
enum { PENDULUM, DOUBLE_PENDULUM, OF_A_FORCE, BENT };

/* The masses and the rods of the two pendulums, g. */
static const double MASS[] = {2, 0.3}, ROD[] = {1.25, 0.75}, GRAVITY = 9.75;

/* A state of a problem. */
typedef struct {
    double t, q[MOST_N], p[MOST_N];
} state;

/* End the test where they fail. */
tvi_system *base_of(const problem *of);
tvi_system *system_of(const problem *of);
/* The state of the problem, put onto its constraints. */
state start_of(const problem *of, const tvi_system *system);
/* "galerkin" of this order, without a limit of the tail. */
tvi_integrator *integrator_of_order(const tvi_system *system, int order);
/* x becomes the state after `steps` steps over `duration`. */
tvi_status make_run(const tvi_system *system, int order, double duration, long steps, state *x);
/* The largest difference of two states' coordinates or momenta; NAN where one is. */
double distance(const problem *of, const state *x, const state *y);

#endif
