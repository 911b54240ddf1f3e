/* curve_stepper.h - declares the workspace of a method that expands one Taylor curve, for curve_stepper.c,
 * curve_batch.c and the quick steps. Generated code includes this text. */
#ifndef TVI_SRC_GENERATING_CURVE_STEPPER_H
#define TVI_SRC_GENERATING_CURVE_STEPPER_H

#include "generating/action.h"
#include "generating/closure.h"
#include "generating/newton.h"
#include "generating/refine.h"
#include "system/legendre.h"
#include "system/roundoff.h"

/* These are the quick steps (seeds.h) compiled for each instruction set, of one member and of several members. */
tvi_quick_step_fn tvi_quick_step_single_base, tvi_quick_step_single_avx2, tvi_quick_step_single_avx512;
tvi_quick_step_fn tvi_quick_step_batch_base, tvi_quick_step_batch_avx2, tvi_quick_step_batch_avx512;
/* This makes steps of the plain Taylor method, of several members. */
tvi_quick_step_fn tvi_taylor_step_batch_base, tvi_taylor_step_batch_avx2, tvi_taylor_step_batch_avx512;

typedef struct tvi_curve_workspace {
    tvi_closure closure;
    bool corrects;
    bool is_rough;
    const tvi_options *options;
    int q_degree;
    tvi_action action;
    tvi_newton newton;
    tvi_legendre legendre;
    tvi_combination q_back;             /* q- - Q_0 */
    tvi_combination q_centre, z_centre; /* the centre data, of the curve that starts at (q0, p0) */
    tvi_combination v_end;              /* tau v at the end of the step, of a Lagrangian */
    tvi_combination dense_q, dense_u;   /* for one point of dense output */
    double *z;                          /* [2n] predictor */
    double *velocity;                   /* [n] the first guess of the next predictor's, Lagrangian; in the history */
    double *chosen;                     /* [width] sizes of the last steps that adapted, 0: none; in the history */
    double *field;                      /* the field's values at the end of such a step, separable systems */
    tvi_roundoff roundoff;              /* the roundoff of these values */
    double tolerance, log_tolerance;    /* those of the last step that adapted */
    double *shift;                      /* [n] */
    tvi_refinement refinement;
    tvi_quick_step_fn *quick_step;              /* the quick step, or NULL */
    const struct tvi_member_stepper *by_itself; /* batches: steps one member alone */
} tvi_curve_workspace;

/* Allocates the work of `width` members, and fills its tables. */
void *tvi_curve_workspace_allocate(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width);
void tvi_curve_workspace_fill_tables(void *work);

/* Returns the solver by products with Jacobians, for the system's instruction set. */
const tvi_closure_solver *tvi_choose_product_solver(const tvi_system *system);
/* Returns whether there is a quick step: for small matrices, and seeds without second derivatives. */
bool tvi_has_quick_step(const tvi_system *system, const tvi_options *options);
/* Returns the quick step, or NULL if there is none. */
tvi_quick_step_fn *tvi_choose_quick_step(const tvi_closure *closure, const tvi_options *options);
/* Returns the function that makes plain Taylor steps of several members. */
tvi_quick_step_fn *tvi_choose_taylor_batch_step(const tvi_system *system);

/* Returns whether the curve ends with the force there, dp/ds = h F, to the tolerance. Coefficients beside a state that
 * is large may not show what the body will meet. */
bool tvi_curve_satisfies_force_at_end(tvi_curve_workspace *work, double h, const tvi_step_origin *origin,
                                      const tvi_increments *increments);

#endif
