/* problem.h - Declares a random problem: a system, a state, a step and a method. */
#ifndef TESTS_FUZZ_STEPS_PROBLEM_H
#define TESTS_FUZZ_STEPS_PROBLEM_H

#include "expression.h"
#include "tvi.h"

#include <stdbool.h>

enum { PARAMETERS_MOST = 6 };
enum { N_MOST = 12, SECOND = N_MOST, TIME = 2 * N_MOST }; /* inputs: q at 0, p or v at SECOND, t */

typedef enum { OF_FORCE, OF_POTENTIAL, OF_LAGRANGIAN, OF_HAMILTONIAN, FORMS } form;

typedef struct {
    form form;
    int n;
    double mass[N_MOST]; /* of a force or a potential */
    formula f;
    int own;      /* the first of n nodes, the coordinates less where they are about */
    int energy;   /* node of V, L or H; of a rescaled system of K = g (H + e), whose last q is t and last p is e, */
    int H, scale; /* and of H and g */
    bool rescales;
    int dq[N_MOST]; /* nodes of F, or of the derivatives of the energy */
    int dp[N_MOST]; /* of the derivatives by v or p */
    bool is_driven;
    formula drive;         /* of q, v and t; */
    int driven_by[N_MOST]; /* its nodes, the forces, which are in dq, too */
    double t, q[N_MOST], p[N_MOST];
    int parameters;
    double parameter[PARAMETERS_MOST]; /* values, which are not those recorded */
} problem;

/* Problem number seed; problem_free frees the formula. */
problem problem_of(uint64_t seed);
void problem_free(problem *x);
tvi_status problem_system(problem *x, tvi_system **system);
/* A method that serves the system, at random; the degree and the nodes are resolved. */
tvi_options random_method(form of, const tvi_system *system, random_source *r);
void print_problem(FILE *to, const problem *x);
const char *describe(const tvi_options *options);

#endif
