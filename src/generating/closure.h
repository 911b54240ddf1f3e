/* closure.h - what a generating function adds to a Taylor curve.
 *
 * A step is the curve from one end to the other plus small corrections, which make it symplectic:
 *     q0 = q- + from_q,   p0 = p- + from_p,   q1 - q0 = (q+ - q-) + rise_q,   p1 - p0 = (p+ - p-) + rise_p.
 * A generating function closes the equations: it computes the corrections from D_z, the gradient of the discrete action
 * in defect form, and the Jacobians of the curve's ends. All else is common to all (curve_stepper.c). */
#ifndef TVI_SRC_GENERATING_CLOSURE_H
#define TVI_SRC_GENERATING_CLOSURE_H

#include "generating/action.h"

enum { TVI_MOST_ITERATIONS = 40 };

/* Equations with a transposed Jacobian A^T x = b, solved by its products. */
typedef struct {
    double *x;                          /* [2n] the solution; that of the last pass is the guess of the next */
    double *r;                          /* [2n] D - A^T x, all of it */
    double *s, *v;                      /* [TVI_MOST_ITERATIONS][2n] directions, and A^T times them */
    double square[TVI_MOST_ITERATIONS]; /* of v */
    double *scratch;                    /* [2n] */
    double *size;                       /* [n] what the unknowns' errors are measured by */
    int last;                           /* the order of the curve to which products are made */
    bool has_guess;
} tvi_iteration;

typedef struct tvi_closure {
    const tvi_system *system;
    int n;
    tvi_span span;
    tvi_curve curve;
    tvi_combination q_from, q_to, q_rise,
        q_mean; /* q-, q+, q+ - q-, and (to q- - from q+)/(to - from), which has no Q_1
                                                     in it: at the midpoint the mean of the ends */
    tvi_combination u_from, u_to, u_rise, u_mean; /* the same of the scaled momentum u = kappa p */
    double *seed_Q, *seed_U;                      /* [top + 1][n] of D_z */
    double *D;                                    /* [2n] D_z, then the solution of the equations */
    double *G;                                    /* [n][2n] scratch for Jacobians of the ends */
    tvi_factor half;                              /* n x n */
    tvi_factor full;                              /* 2n x 2n */
    bool is_fresh;                                /* the Jacobians are new: the factors must be, too */
    tvi_iteration iteration;                      /* instead of factors where the Jacobians are had as products */
    double *from_q, *from_p, *rise_q, *rise_p;    /* [n] the corrections */
} tvi_closure;

/* Blocks of a Jacobian [n][2n]: the columns of the first or of the second half of z. */
typedef enum { TVI_FIRST, TVI_SECOND } tvi_half;

/* With D = D_z: solves J^T x = D for the half of D that belongs to the n x n block J of the combination's Jacobian,
 * leaves x there, and takes the other block's part from the other half. One such matrix a generating function: its
 * factor is kept as long as the Jacobians are. TVI_ESINGULAR, TVI_ENONFINITE, TVI_ENOCONV. */
TVI_NODISCARD tvi_status tvi_close_half(tvi_closure *closure, const tvi_combination *combination, tvi_half half);

/* With D = D_z: solves [J1; J2]^T (x, y) = D in place. */
TVI_NODISCARD tvi_status tvi_close_full(tvi_closure *closure, const tvi_combination *first,
                                        const tvi_combination *second);

/* Takes what the closing needs from the arena, for Jacobians as the curve has them. */
void tvi_close_take(tvi_closure *closure, tvi_arena *arena);

/* correction <- J^-1 correction, nearly, J = d(q-, u-)/dz of a separable system, by one product. */
void tvi_close_correct(tvi_closure *closure, double correction[]);

/* Type I: p0 = p- + d0 and p1 - p0 = (p+ - p-) + rise, [n] each; the curve joins q0 to q1. */
void tvi_close_momenta(tvi_closure *closure, const double d0[], const double rise[]);
/* Type I, expanded anywhere inside the step. */
tvi_close_fn tvi_close_type1;

#endif
