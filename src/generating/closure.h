/* closure.h - declares the closure, which computes the small corrections that a generating function adds to a Taylor
 * curve. curve_stepper.c calls it in each pass.
 *
 * A step is the curve from one end to the other plus small corrections, which make it symplectic:
 *     q0 = q- + from_q,   p0 = p- + from_p,   q1 - q0 = (q+ - q-) + rise_q,   p1 - p0 = (p+ - p-) + rise_p.
 * A generating function closes the equations: it computes the corrections from D_z, the gradient of the discrete action
 * in defect form, and the Jacobians of the curve's ends. Everything else is the same for all generating functions
 * (curve_stepper.c). This file is part of the text of generated code. */
#ifndef TVI_SRC_GENERATING_CLOSURE_H
#define TVI_SRC_GENERATING_CLOSURE_H

#include "generating/seeds.h"
#include "method/closing.h"

/* Names the n x n block of a Jacobian [n][2n] that has the columns of the first or of the second half of z. */
typedef enum { TVI_FIRST, TVI_SECOND } tvi_half;

/* These are equations A^T x = D_z with Jacobians of the curve's ends: A is the n x n block `half` of one Jacobian, or
 * two Jacobians whole. */
typedef struct {
    const tvi_combination *first, *second; /* the Jacobians' combinations; second is NULL if there is only one */
    tvi_half half;                         /* the block, if there is only one Jacobian */
} tvi_transposed_equations;

/* A solver solves these equations; the generating functions do not know which one does (matrices.c, products.c). */
typedef struct tvi_closure_solver {
    void (*take)(struct tvi_closure *closure, tvi_arena *arena);
    void (*begin)(struct tvi_closure *closure); /* begins a step: discards the factors of the step before */
    /* Computes the corrections from the curve at z and its seeds. scale [2n]: the natural sizes of z. */
    tvi_status (*close)(struct tvi_closure *closure, const double z[], const double scale[], tvi_stats *stats);
    /* Replaces D [2n] by the solution x in the rows of the unknowns, and by the residual of D_z in the others. Returns
     * TVI_ESINGULAR, TVI_ENONFINITE or TVI_ENOCONV. */
    tvi_status (*solve)(struct tvi_closure *closure, const tvi_transposed_equations *equations);
    /* The corrector has one of the next two functions. `jacobian` writes J = d(q-, u-)/dz [2n][2n], or returns false if
     * the last Jacobian still serves; `correct` replaces the correction by nearly J^-1 times it. */
    bool (*jacobian)(const struct tvi_closure *closure, double matrix[]);
    void (*correct)(struct tvi_closure *closure, double correction[]);
} tvi_closure_solver;
extern const tvi_closure_solver tvi_solver_by_matrices, tvi_solver_by_products_base, tvi_solver_by_products_avx2,
    tvi_solver_by_products_avx512;

typedef struct tvi_closure {
    const tvi_system *system;
    int n;
    tvi_scaled_span span;
    tvi_curve curve;
    /* The combinations whose sums are q-, q+, q+ - q-, and (to q- - from q+)/(to - from). The last one has no term in
     * Q_1; it is the mean of the ends if the curve is expanded at the midpoint. */
    tvi_combination q_from, q_to, q_rise, q_mean;
    tvi_combination u_from, u_to, u_rise, u_mean; /* the same combinations of the scaled momentum u */
    tvi_combination p_sizes;                      /* the weights whose sum over |U_k| is p_size */
    int p_degree;                                 /* the degree of the momentum */
    double *p_size;                               /* [n] sum_k |P_k| */
    tvi_correct_ends_fn *close;                   /* the generating function's closing */
    const tvi_mean_factors *mean;                 /* the factors of tvi_close_by_mean_of_ends, or NULL */
    double *seed_Q, *seed_U;                      /* [top + 1][n] the seeds of D_z */
    double *D;                                    /* [2n] D_z, then the solution of the equations */
    const tvi_closure_solver *solver;
    void *solving;                             /* the solver's own data, such as factors */
    double *from_q, *from_p, *rise_q, *rise_p; /* [n] the corrections */
} tvi_closure;

/* Solves J^T x = D_z for the half of D_z that belongs to the n x n block J of the combination's Jacobian. In D, x
 * replaces that half, and the other half becomes what the other block leaves of it. Returns the statuses of
 * tvi_closure_solver. */
TVI_NODISCARD tvi_status tvi_solve_transposed_half(tvi_closure *closure, const tvi_combination *combination,
                                                   tvi_half half);

/* Solves [J1; J2]^T (x, y) = D_z, and replaces D by (x, y). */
TVI_NODISCARD tvi_status tvi_solve_transposed_full(tvi_closure *closure, const tvi_combination *first,
                                                   const tvi_combination *second);

/* Returns the combination whose Jacobian is J2 if the mean of the ends is J1. */
static inline const tvi_combination *closure_partner_of_mean(const tvi_closure *closure)
{
    return closure->mean->uses_mean_momentum ? &closure->u_mean : &closure->q_rise;
}

/* Solves these equations with the mean of the ends as J1, and makes the corrections that closure->mean says. */
tvi_correct_ends_fn tvi_close_by_mean_of_ends;

/* Computes the corrections from the solution in D, as closure->mean says. */
static inline void closure_correct_ends(const tvi_closure *closure)
{
    const tvi_mean_factors *mean = closure->mean;
    const int width = curve_width(&closure->curve);
    double *restrict from_q = closure->from_q, *restrict rise_q = closure->rise_q;
    double *restrict from_p = closure->from_p, *restrict rise_p = closure->rise_p;
    for (int i = 0; i < curve_dimension(&closure->curve); i++)
        for (int at = i * width; at < (i + 1) * width; at++) {
            const double x = closure->D[at], y = closure->D[curve_numbers(&closure->curve) + at],
                         of_q = closure->curve.kappa[i] * y;
            from_q[at] = mean->from_q_factor * of_q;
            rise_q[at] = mean->rise_q_factor * of_q;
            from_p[at] = mean->from_p_factor[0] * x + mean->from_p_factor[1] * y;
            rise_p[at] = mean->rise_p_factor[0] * x + mean->rise_p_factor[1] * y;
        }
}

/* Sets p_size [n], the sums of the sizes of the terms of p, by which corrections of p are measured. */
static inline void closure_set_p_size(const tvi_closure *closure)
{
    curve_sum_combination_by(tvi_add_weighted_magnitudes, &closure->curve, &closure->p_sizes, closure->p_size);
    const int width = curve_width(&closure->curve);
    for (int i = 0; i < curve_dimension(&closure->curve); i++)
        for (int at = i * width; at < (i + 1) * width; at++) closure->p_size[at] /= fabs(closure->curve.kappa[i]);
}

/* Closes type I, expanded at the start or the end of the step. */
tvi_correct_ends_fn tvi_close_type1_end;

#endif
