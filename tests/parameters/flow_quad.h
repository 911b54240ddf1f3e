/* flow_quad.h - Declares the flow of the problem of parameters.h in quadruple precision. */
#ifndef TESTS_FLOW_QUAD_H
#define TESTS_FLOW_QUAD_H

/* (q, p)[4] of the potential or the Hamiltonian, moved on by t, and its derivative with respect to parameter `which`
 * by a difference; each exact to 1e-14. */
void exact_sensitivity(int is_hamiltonian, const double parameter[], int which, const double from[], double t,
                       double rate[]);

#endif
