/* models.h - Declares what the suites run on: problems of every form with their exact ends, and every generating
 * function. Letters as in docs/method.md. */
#ifndef TESTS_GENERATING_MODELS_H
#define TESTS_GENERATING_MODELS_H

#include "problems/statistics.h"
#include "problems/problems.h"

/* ---- Problems ---------------------------------------------------------------------------------------------------- */

/* The options that a problem can be run with. */
enum { WITH_TYPE1 = 1, WITH_HAMILTON = 2, WITH_ALL = WITH_TYPE1 | WITH_HAMILTON };

typedef struct model {
    const char *name;
    int n, with;
    const test_problem *problem; /* of a force or a potential, else NULL: */
    const scene *scene;          /* a general scene, else NULL: */
    tvi_lagrangian_fn *lagrangian;
    tvi_hamiltonian_fn *hamiltonian; /* one of the two */
    double t0, t_end;                /* of a short run; a scene's own end may be later */
    double h;                        /* a step of usual size */
    int steps;                       /* as many as roundoff does not grow much in */
    int most_order; /* whose slope settles before roundoff ends the line, where that is known; 0: any */
} model;

/* sheared_*: the driven chain of problems.h in coordinates x, q = S x, after a change of gauge f(q, t) (statements.h):
 * the mass is no longer diagonal, velocities stand in the force, and time stands in every term. */
extern const model model_pendulum, model_kepler, model_chain, model_double_pendulum, model_magnetic, model_nonseparable,
    model_vortices, model_degenerate, model_sheared_lagrangian, model_sheared_hamiltonian, model_henon_heiles;
extern const model *const models[];
enum {
    MODEL_PENDULUM,
    MODEL_KEPLER,
    MODEL_CHAIN,
    MODEL_DOUBLE_PENDULUM,
    MODEL_MAGNETIC,
    MODEL_NONSEPARABLE,
    MODEL_VORTICES,
    MODEL_DEGENERATE,
    MODEL_SHEARED_LAGRANGIAN,
    MODEL_SHEARED_HAMILTONIAN,
    MODELS,                      /* of every suite */
    MODEL_HENON_HEILES = MODELS, /* of the orders alone */
    MODELS_OF_ORDERS
};

/* Ends the test where it cannot be made. */
tvi_system *model_system(const model *m);
test_state model_start(const model *m);
/* Near the start, away from any symmetry. */
test_state model_place(const model *m);

/* The solution at t0 + k (t_end - t0)/PARTS, k = 1..PARTS, and what roundoff alone makes of the state there. By a fine
 * run of order 16, which is checked against the scene's reference or problem_exact at the end. */
enum { PARTS = 2 };
typedef struct {
    test_state at[PARTS];
    two_errors roundoff;
} model_path;
model_path model_solution(const model *m);

/* ---- Generating functions ---------------------------------------------------------------------------------------- */

typedef struct {
    tvi_method method;
    tvi_expansion expansion;
    tvi_nodes nodes;
    bool symmetric;
} kind;

/* All that the library has, with each of their node rules: those that expand curves, then the Galerkin curve. */
enum { KINDS_MOST = 100 };
extern kind kinds[KINDS_MOST];
extern int kind_count, all_kinds; /* of curves, and with the Galerkin curve, which is at kind_count */

tvi_options kind_options(const kind *k, int degree);
tvi_options kind_options_with(const kind *k, int degree, tvi_quadrature quadrature, int points);
/* Whether the model can be run with it. */
bool kind_serves(const kind *k, const model *m);
/* The degrees are 1, 2, ..., but Poincare begins with 0, which the options call order 2. */
int kind_least_degree(const kind *k);

/* Text that lives until the next call but seven. */
const char *describe(const tvi_options *options);

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

/* Ends the test where it cannot be made. */
tvi_integrator *integrator_of(const tvi_system *system, const tvi_options *options);
/* The test fails where a step does. */
void go(tvi_integrator *integrator, double h, long steps, test_state *x);
/* Errors of H after steps of ORBITS orbits that start about x. */
sample energy_errors(const model *m, const test_state *x, const tvi_options *options, double h, long steps);
/* A step from x that continues no other, with its Jacobian M[2n][2n], rows and columns (q, p). The test fails where it
 * does. */
void go_tangent(int n, tvi_integrator *integrator, double h, test_state *x, double M[]);
/* The largest element of M^T J M - J. */
double symplectic_defect(int n, const double M[]);
/* max over q and p of |a - b|, each relative to the largest component of b or 1. */
double distance(int n, const test_state *a, const test_state *b);

#endif
