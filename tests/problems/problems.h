/* problems.h - Declares what the suites run on: the bench's scenes and a driven chain, each with its force once more by
 * hand, and the runs, norms and reference solutions that the suites share. Letters as in docs/method.md. */
#ifndef TESTS_PROBLEMS_H
#define TESTS_PROBLEMS_H

#include "scene.h"

#include <check.h>

enum { N_MAX = 18 }; /* degrees of freedom */

typedef void plain_force_fn(long double t, const long double q[], long double F[]);

typedef struct {
    const scene *scene;
    tvi_force_fn *force;   /* what is recorded instead of the scene's potential, NULL = the potential */
    plain_force_fn *plain; /* the same F in plain numbers: shares nothing with the library */
    double t0, t_end;      /* of a short run */
} test_problem;

/* The chain: n = 3, masses 1, 2.5, 0.4, springs k d^2/2 + a d^3/3 + b d^4/4 with k = 4 between the walls and the
 * masses, a force A cos(w t) on the first mass with w = 1.7, recorded as a force, from t0 = 0.3. */
extern const test_problem problem_pendulum, problem_kepler, problem_henon_heiles, problem_chain, problem_solar,
    problem_fpu;

/* Eight particles, as many as have products (jacobian.c), with operations whose adjoints are handed on to all lower
 * orders: exp, cos and a quotient. */
extern const scene scene_ring;
extern const test_problem problem_ring;

/* Second derivatives of the chain's potential, [3][3]. */
void chain_hessian(const long double q[], long double H[]);

/* Ends the test where it cannot be made. */
tvi_system *problem_system(const test_problem *problem);

typedef struct {
    double t, q[N_MAX], p[N_MAX];
} test_state;

typedef struct {
    long double t, q[N_MAX], p[N_MAX];
} exact_state;

typedef struct {
    double q, p; /* largest component */
} two_errors;

test_state problem_start(const test_problem *problem);

/* The methods as they are defined: no step is refused as too large. */
tvi_options options_type1(tvi_expansion expansion, tvi_nodes nodes, int degree);
tvi_options options_taylor(int degree);
tvi_options options_verlet(void);

/* An integrator and the problem it runs; ends the test where it cannot be made. */
typedef struct {
    const test_problem *problem;
    tvi_system *system;
    tvi_integrator *integrator;
} runner;

runner runner_open(const test_problem *problem, const tvi_options *options);
void runner_close(runner *run);
/* steps steps of size h; the test fails where one does. */
void runner_steps(const runner *run, double h, long steps, test_state *state);
/* The state at problem->t_end from problem_start in `steps` steps. */
test_state problem_run(const test_problem *problem, const tvi_options *options, long steps);

/* The state at t_end to about 3e-17, from `start` or, where it is NULL, problem_start: Stormer-Verlet in long double on
 * the plain force, extrapolated in h^2. */
exact_state problem_exact(const test_problem *problem, const test_state *start, double t_end);
/* The change of the state that a relative change by DBL_EPSILON makes, here and at problem->t_end: no run can be
 * better. */
two_errors problem_roundoff(const test_problem *problem);

/* H = sum p_i^2/(2 m_i) + V of the library's system. */
double state_energy(const tvi_system *system, const test_state *state);

/* The largest component of the difference in q and in p. */
two_errors state_difference(int n, const test_state *a, const test_state *b);
two_errors state_error(int n, const test_state *a, const exact_state *exact);
double larger(two_errors errors);

double problem_mass(const test_problem *problem, int i);

#endif
