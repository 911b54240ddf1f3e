/* closure.h - declares the closure of a step, which computes the small corrections that a generating function adds to a
 * Taylor curve. curve_stepper.c calls it in each pass.
 *
 * A step is the curve from one end to the other plus small corrections, which make it symplectic:
 *     q0 = q- + from_q,   p0 = p- + from_p,   q1 - q0 = (q+ - q-) + rise_q,   p1 - p0 = (p+ - p-) + rise_p.
 * The equations of a generating function determine these corrections of the ends from D_z, the gradient of the discrete
 * action in defect form, and from the Jacobians of the curve's ends. Everything else is the same for all generating
 * functions (curve_stepper.c). This file is part of the text of generated code. */
#ifndef TVI_SRC_GENERATING_CLOSURE_H
#define TVI_SRC_GENERATING_CLOSURE_H

#include "generating/seeds.h"
#include "method/closing.h"

/* Names the n x n block of a Jacobian [n][2n] that has the columns of the first or of the second half of z. */
typedef enum { TVI_FIRST, TVI_SECOND } tvi_half;

/* The equations A^T x = D_z. A is one n x n block of the Jacobian of an end of the curve; or it consists of two such
 * Jacobians, n x 2n each, one above the other. */
typedef struct {
    const tvi_combination *first_combination,
        *second_combination; /* the combinations whose Jacobians are in A; second_combination is NULL if A is a block */
    tvi_half half;           /* the block, if A is one */
} tvi_transposed_equations;

/* A solver of such equations, by matrices (matrices.c) or by products (products.c). The generating functions do not
 * know which of them is used. */
typedef struct tvi_closure_solver {
    void (*take)(struct tvi_closure *closure, tvi_arena *arena);
    void (*begin)(
        struct tvi_closure *closure); /* begins a step: it discards the factors and guesses of the step before */
    /* Computes the corrections of the ends from the curve at z and its seeds. scale [2n] has the natural sizes of z. */
    tvi_status (*compute_corrections)(struct tvi_closure *closure, const double z[], const double scale[],
                                      tvi_stats *stats);
    /* Replaces D [2n]: the rows of the unknowns by the solution x, and the other rows by the residual of the equations
     * in these rows. Returns TVI_ESINGULAR, TVI_ENONFINITE or TVI_ENOCONV. */
    tvi_status (*solve)(struct tvi_closure *closure, const tvi_transposed_equations *equations);
    /* The corrector uses one of the next two functions; the other is NULL. `jacobian` writes J = d(q-, u-)/dz [2n][2n],
     * or returns false if the corrector may reuse the Jacobian before it; `correct` multiplies the correction by an
     * approximate J^-1. */
    bool (*jacobian)(const struct tvi_closure *closure, double matrix[]);
    void (*correct)(struct tvi_closure *closure, double correction[]);
} tvi_closure_solver;
extern const tvi_closure_solver tvi_solver_by_matrices;

typedef struct tvi_closure {
    const tvi_system *system;
    int n;
    tvi_scaled_span span;
    tvi_curve curve;
    /* The combinations of Q_k whose sums are q-, q+, q+ - q-, and (to q- - from q+)/(to - from), with the ends `from`
     * and `to` of the span. The last one has no term in Q_1; it is the mean of the ends if the curve is expanded at the
     * midpoint. */
    tvi_combination q_from, q_to, q_rise, q_mean;
    tvi_combination u_from, u_to, u_rise, u_mean; /* the same combinations of the scaled momentum u */
    tvi_combination momentum_size_weights; /* the weights of |U_k| whose sum, divided by |kappa|, is momentum_size */
    int p_degree;                          /* the degree to which the momentum is summed */
    double *momentum_size;                 /* [n] sum_k |P_k| */
    tvi_correct_ends_fn *correct_ends;     /* computes the corrections by the equations of the generating function */
    const tvi_mean_factors *mean_factors;  /* the factors of the solution in the corrections */
    double *seed_Q, *seed_U;               /* [top + 1][n] the seeds of D_z */
    double *D;                             /* [2n] D_z, then the solution of the equations */
    const tvi_closure_solver *solver;
    void *solver_data; /* the memory of the solver: tvi_jacobian_factors or tvi_conjugate_residuals */
    double *from_q, *from_p, *rise_q, *rise_p; /* [n] the corrections of the ends */
} tvi_closure;

/* Returns the second combination of tvi_correct_ends_by_mean. */
static inline const tvi_combination *closure_get_second_combination(const tvi_closure *closure)
{
    return closure->mean_factors->uses_mean_momentum ? &closure->u_mean : &closure->q_rise;
}

/* Solves [J1; J2]^T (x, y) = D_z with the Jacobians of q_mean and of the second combination, and computes the
 * corrections from (x, y) by mean_factors. */
tvi_correct_ends_fn tvi_correct_ends_by_mean;

/* Solves J^T x = D_z, with J the n x n block `half` of the combination's Jacobian and the same half of D_z. In D, x
 * replaces this half; the other half becomes D_other - J_other^T x, with the other block of the Jacobian. Computes the
 * corrections from the halves (x, y) of D by mean_factors. */
TVI_NODISCARD tvi_status tvi_correct_ends_by_block(tvi_closure *closure, const tvi_combination *combination,
                                                   tvi_half half);

/* Computes the corrections of the ends from the solution (x, y) in D by mean_factors. */
static inline void closure_set_corrections(const tvi_closure *closure)
{
    const tvi_mean_factors *mean = closure->mean_factors;
    const int width = curve_width(&closure->curve);
    double *restrict from_q = closure->from_q, *restrict rise_q = closure->rise_q;
    double *restrict from_p = closure->from_p, *restrict rise_p = closure->rise_p;
    for (int i = 0; i < curve_dimension(&closure->curve); i++)
        for (int at = i * width; at < (i + 1) * width; at++) {
            const double x = closure->D[at], y = closure->D[curve_vector_length(&closure->curve) + at],
                         of_q = closure->curve.kappa[i] * y;
            from_q[at] = mean->from_q_factor * of_q;
            rise_q[at] = mean->rise_q_factor * of_q;
            from_p[at] = mean->from_p_factor[0] * x + mean->from_p_factor[1] * y;
            rise_p[at] = mean->rise_p_factor[0] * x + mean->rise_p_factor[1] * y;
        }
}

/* Computes momentum_size, by which corrections of p are measured. */
static inline void closure_compute_momentum_sizes(const tvi_closure *closure)
{
    curve_sum_combination_by(tvi_add_weighted_magnitudes, &closure->curve, &closure->momentum_size_weights,
                             closure->momentum_size);
    const int width = curve_width(&closure->curve);
    for (int i = 0; i < curve_dimension(&closure->curve); i++)
        for (int at = i * width; at < (i + 1) * width; at++)
            closure->momentum_size[at] /= fabs(closure->curve.kappa[i]);
}

#endif
