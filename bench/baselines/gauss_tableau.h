/* gauss_tableau.h - Declares Gauss collocation with s nodes, for y' = f(y) and for q'' = a(q) (docs/method.md section
 * 4, Galerkin). */
#ifndef GAUSS_TABLEAU_H
#define GAUSS_TABLEAU_H

enum { GAUSS_STAGES_MAX = 8 };

typedef struct {
    int s;
    long double node[GAUSS_STAGES_MAX];                            /* c_i in (0, 1), ascending */
    long double weight[GAUSS_STAGES_MAX];                          /* b_j */
    long double position_weight[GAUSS_STAGES_MAX];                 /* b_j (1 - c_j) */
    long double first_order[GAUSS_STAGES_MAX][GAUSS_STAGES_MAX];   /* A_ij */
    long double matrix[GAUSS_STAGES_MAX][GAUSS_STAGES_MAX];        /* (A^2)_ij */
    long double extrapolation[GAUSS_STAGES_MAX][GAUSS_STAGES_MAX]; /* l_j(1 + c_i): the next step from this one */
} gauss_tableau;

/* The tableau of s stages, made at the first call. Not for several threads. */
const gauss_tableau *gauss_tableau_of(int s);

#endif
