/* newton.h - declares the corrector, which solves a method's equations r(x) = 0 by passes x <- x - K^-1 r(x) with an
 * approximate Jacobian K, until the corrections are roundoff (docs/method.md section 5). The steppers step.c and
 * both_ends.c call it. */
#ifndef TVI_SRC_GENERATING_NEWTON_H
#define TVI_SRC_GENERATING_NEWTON_H

#include "algebra/linear.h"
#include "algebra/passes.h"
#include "system/system.h"

/* [1] An unknown smaller than this part of the largest of its group is measured as if it had this size. */
#define NEWTON_MIN_SCALE 1e-20 /* found: make check-generating */

/* The equations r(x) = 0 of a method. Its functions are called with `self`. */
typedef struct {
    void *self;
    /* Computes the residual r(x); x and r have as many numbers as there are unknowns. */
    tvi_status (*residual)(void *self, const double x[], double r[]);
    /* Computes the natural size of each unknown. A correction below the roundoff of this size counts as 0. The function
     * is called after the first residual, and where corrections have moved an unknown by about its size. */
    void (*scale)(void *self, double scale[]);
    /* Computes an approximate dr/dx at the x of the last residual; NULL: the Jacobian is the identity, or `solve` is
     * used. The function returns false, and leaves `matrix` alone, if the matrix of the last call can be reused. */
    bool (*jacobian)(void *self, double matrix[]);
    /* Computes correction <- (dr/dx)^-1 correction, approximately, without a matrix; NULL: `jacobian` is used, or the
     * Jacobian is the identity. */
    void (*solve)(void *self, double correction[]);
    /* Estimates an upper bound of the roundoff of each component of the last residual: a unit of roundoff times the
     * size of the numbers from which it was computed, which may be larger than the unknowns. The function is called if
     * passes no longer contract. */
    void (*roundoff)(void *self, double r[]);
} tvi_equations;

typedef struct {
    bool has_jacobian;      /* whether there is memory for a Jacobian matrix */
    bool is_by_differences; /* whether the Jacobian in it was computed by differences */
    bool makes_extra_pass;  /* whether each solution makes one pass more than seems needed */
    /* The rules by which passes end: that of the largest correction relative to its unknown's scale, and that of the
     * largest correction of a group relative to the largest scale of the group. */
    tvi_stopping_rule unknown_rule, group_rule;
    int size;                         /* the number of unknowns */
    int group;                        /* the number of unknowns in one group; all unknowns of a group have one unit */
    const tvi_subsystems *subsystems; /* the subsystems of the system, whose components are compared with one another */
    double *x, *correction, *scale;   /* [size] the unknowns, their last corrections and natural sizes */
    double *roundoff_scale;           /* the scale plus a multiple of the unknown's change by the residual's roundoff */
    double *trial_x, *trial_r;        /* [size] scratch */
    tvi_lu_factor factor;
    /* The largest factor by which the contraction ratio grew from one pass to the next in earlier solutions, or 0 if
     * there was none; part of the history. */
    double *known_growth;
} tvi_newton;

/* Allocates the corrector of equations with `groups` groups of n unknowns; equations with a `solve` need no
 * Jacobian. */
void tvi_newton_allocate(tvi_newton *newton, tvi_arena *arena, int groups, const tvi_system *system, bool has_jacobian);

/* Sets the rules, once. makes_extra_pass says that the first contraction is no measure of the later ones, so that there
 * is always one more pass than seems needed. */
void tvi_newton_set_rules(tvi_newton *newton, const tvi_options *options, bool makes_extra_pass);

/* Solves the equations from the predictor in newton->x. On success newton->x is the point of the last residual, and
 * newton->correction is the last correction, which has not been added. The caller applies it to first order, which
 * leaves an error of second order in the correction and saves one evaluation. Returns TVI_ENOCONV if passes do not
 * contract, even with a Jacobian by differences, otherwise the status of the equations or of the factorisation. Counts
 * passes and factorisations, and sets stats->residual. */
TVI_NODISCARD tvi_status tvi_newton_solve(tvi_newton *newton, const tvi_equations *equations, tvi_stats *stats);

#endif
