/* regression.h - the drives of a step by those of the two before, by least squares; compiled once for each instruction
 * set. */
#ifndef TVI_SRC_GALERKIN_REGRESSION_H
#define TVI_SRC_GALERKIN_REGRESSION_H

#include <stdbool.h>

/* Of arrays of lanes those that are no nodes are 0. Polynomials of degree k < 2 points, orthonormal at the nodes of two
 * steps, have the column k of `basis`, and the row k of `ahead` at the nodes of the next one, up to the degree that is
 * extrapolated by; of_last is what polynomials through the last step's alone make of its drives. */
typedef struct {
    int lanes, unknowns, samples; /* of each window */
    double gain;                  /* what polynomials lack is larger by this factor at least */
    int halves;                   /* of the unknowns: 1, or 2 of coordinates and of momenta */
    const double *scale;          /* [unknowns] of the nodes: how far they move by their drives */
    double *weight;               /* [unknowns] 1 / the size of their drives, as much as it counts beside the others */
    double *per_weight;           /* [lanes] 1 / b */
    double *basis;                /* [2 lanes][2 lanes] */
    double *ahead;                /* [2 lanes][lanes] */
    double *of_last;              /* [lanes][lanes] */
    double *rise;                 /* [lanes][lanes] what the unknowns of the next step have of its drives */
    double *sample; /* [windows][samples][unknowns][3 lanes] two steps by polynomials, and what these lack in the
                           next one: both relative to the size of that in all unknowns */
    double *gram;   /* [2 lanes][2 lanes] the equations, of the diagonal and above, */
    double *factor; /* [2 lanes][lanes] their right sides, and then the solution: what is added to `ahead` */
} galerkin_regression;

/* So many windows of steps that follow one another: the last one shows what the others say of it. */
enum { REGRESSION_WINDOWS = 4 };

/* impulses [windows][samples + 2][unknowns][lanes], of the steps of a window the last one first. Sets table
 * [2 lanes][lanes], the unknowns by the impulses of two steps. False where that does not leave less, in the last
 * window, than polynomials lack, by the factor `gain` as a geometric mean, or the equations have no solution. */
typedef bool galerkin_regress(const galerkin_regression *w, const double *impulses, double *table);
galerkin_regress tvi_galerkin_regress_base, tvi_galerkin_regress_avx2, tvi_galerkin_regress_avx512;

#endif
