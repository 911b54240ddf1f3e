/* statements.h - Declares one problem, four statements: Kepler and the driven chain of problems.h. */
#ifndef TESTS_GENERATING_STATEMENTS_H
#define TESTS_GENERATING_STATEMENTS_H

#include "problems/problems.h"

enum { CHAIN_N = 3 };
extern const double chain_masses[CHAIN_N];

tvi_force_fn kepler_as_force;
tvi_potential_fn kepler_as_potential, chain_as_potential;
tvi_lagrangian_fn kepler_as_lagrangian, chain_as_lagrangian;
tvi_hamiltonian_fn kepler_as_hamiltonian, chain_as_hamiltonian;

/* With q = S x, S unit lower triangular, and f = a q_0 q_1^2 + b q_0 q_2 cos(w t):
 *   L(x, x', t) = L_chain(q, q', t) + df/dt,   so that the momenta of x are P = S^T (p + f_q). */
tvi_lagrangian_fn sheared_lagrangian;
tvi_hamiltonian_fn sheared_hamiltonian;
/* (x, P) of the chain's (q, p). */
exact_state sheared_state(const exact_state *chain);

#endif
