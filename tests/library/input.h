/* input.h - Declares what the tests of bad input share: a state that is compared bit for bit, and the methods to go
 * through. */
#ifndef TVI_TESTS_INPUT_H
#define TVI_TESTS_INPUT_H

#include "problems/refusals.h"
#include "scenes/scene.h"
#include "tvi.h"

#include <check.h>

enum { STATE_MAX = 4 }; /* coordinates */

typedef struct {
    double t, q[STATE_MAX], p[STATE_MAX];
} state;

state start_of(const scene *s);
bool state_is_finite(const state *s);
void expect_same(const char *what, const state *is, const state *was); /* bit for bit */
/* Every method, at orders that it has. */
typedef struct {
    const char *name;
    int order;
} method;
extern const method methods[];
extern const int method_count;

tvi_system *create_system(int n, tvi_potential_fn *potential);
tvi_system *create_scene(const scene *s);
tvi_options options_of(const method *m);
tvi_integrator *create_integrator(const tvi_system *system, const method *m);
/* A step, which ends with a finite state or leaves it as it was. */
tvi_status step_once(tvi_integrator *integrator, double h, state *s);

/* The four ways to state a problem. */
typedef enum { FORCE, POTENTIAL, LAGRANGIAN, HAMILTONIAN, STATEMENTS } statement;

typedef struct {
    tvi_force_fn *force;
    tvi_potential_fn *potential;
    tvi_lagrangian_fn *lagrangian;
    tvi_hamiltonian_fn *hamiltonian;
} functions;

/* For functions that set out to NULL. */
#define NOT_NULL ((tvi_system *)&(char){0})

/* The system is made or not, as the status says. */
void expect_system(const char *what, statement by, int n, const double mass[], const functions *f, void *ctx,
                   tvi_status wanted, const char *culprit);

/* Problem and method of a loop over problem_count * method_count pairs. */
typedef struct {
    const scene *problem;
    const method *m;
    tvi_system *system;
    char name[80];
} pair;

bool open_pair(pair *x, int i); /* false where the method does not serve the problem */
void close_pair(pair *x);
extern const int problem_count;
extern const double good_step; /* which every method can make for every problem */

tvi_potential_fn harmonic; /* |q|^2/2, n = 2 */

/* With V = log q_0 + q_1^4 and n = 2: L = |v|^2/2 + (q_0 - 1) v_0 v_1 - V and H = |p|^2/2 + (q_0 - 1) p_0 p_1 + V,
 * which are regular but at q_0 = 0 and 2. */
tvi_lagrangian_fn mixed_lagrangian;
tvi_hamiltonian_fn mixed_hamiltonian;

TCase *tcase_systems(void);      /* in input_systems.c */
TCase *tcase_vectors(void);      /* in input_vectors.c */
TCase *tcase_options(void);      /* in input_options.c */
TCase *tcase_functions(void);    /* in input_functions.c */
TCase *tcase_bad_steps(void);    /* in input_steps.c */
TCase *tcase_failed_steps(void); /* in input_failures.c */
/* in input_runs.c */
TCase *tcase_integrate(void);
TCase *tcase_dense(void);
TCase *tcase_stats(void);
TCase *tcase_texts(void); /* in input_texts.c */

#endif
