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

/* The quick steps (curve_step.h) of one member and of several members, compiled for each instruction set. */
tvi_quick_step_fn tvi_quick_step_single_base, tvi_quick_step_single_avx2, tvi_quick_step_single_avx512;
tvi_quick_step_fn tvi_quick_step_batch_base, tvi_quick_step_batch_avx2, tvi_quick_step_batch_avx512;
/* The steps of several members by the plain Taylor method, compiled for each instruction set. */
tvi_quick_step_fn tvi_taylor_step_batch_base, tvi_taylor_step_batch_avx2, tvi_taylor_step_batch_avx512;

typedef struct tvi_curve_workspace {
    tvi_closure closure;
    bool has_corrections;
    bool needs_extra_pass;
    const tvi_options *options;
    int q_degree;
    tvi_action action;
    tvi_newton newton;
    tvi_legendre legendre;
    tvi_combination q_centre_to_start; /* the difference q- - Q_0 */
    /* The centre data q and tau v, or p of a Hamiltonian, as values of the curve that starts at (q0, p0). */
    tvi_combination q_at_centre, velocity_at_centre;
    tvi_combination scaled_end_velocity; /* of a Lagrangian: tau v at the end of the step */
    tvi_combination dense_q, dense_u;    /* the increments to one point of dense output */
    double *predicted_z;                 /* [2n] the predicted centre data */
    /* [n] of a Lagrangian: the first guess of the velocity in the next predictor; part of the history. */
    double *velocity_guess;
    double *last_adapted_step; /* [width] the size of each member's last adapted step, or 0; part of the history */
    double *end_field;         /* of separable systems: the block of the field at the end of an adapted step */
    tvi_roundoff end_field_roundoff; /* the roundoff of the field there */
    double tolerance, log_tolerance; /* the tolerance of the last adapted step, and its logarithm */
    double *scratch;                 /* [n] */
    tvi_refinement refinement;
    tvi_quick_step_fn *quick_step;                   /* the quick step, or NULL */
    const struct tvi_member_stepper *single_stepper; /* only in batches: makes the step of a single member */
} tvi_curve_workspace;

/* tvi_curve_workspace_allocate allocates the workspace of `width` members; the other function fills its tables, once.
 * */
void *tvi_curve_workspace_allocate(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width);
void tvi_curve_workspace_fill_tables(void *work);

/* Returns the solver by products with Jacobians that is compiled for the system's instruction set. */
const tvi_closure_solver *tvi_choose_product_solver(const tvi_system *system);
/* Returns whether the method has a quick step: its ends are corrected by the mean, its matrices are small, and its
 * seeds need no second derivatives. */
bool tvi_has_quick_step(const tvi_system *system, const tvi_options *options);
/* Returns the quick step, or NULL if there is none. */
tvi_quick_step_fn *tvi_choose_quick_step(const tvi_closure *closure, const tvi_options *options);
/* Returns the function that makes plain Taylor steps of several members. */
tvi_quick_step_fn *tvi_choose_taylor_batch_step(const tvi_system *system);

/* Returns whether dp/ds = h F holds at the end of the curve, to the tolerance. The coefficients at the start do not
 * show a force that the body meets only within the step. */
bool tvi_curve_satisfies_force_at_end(tvi_curve_workspace *work, double h, const tvi_step_origin *origin,
                                      const tvi_increments *increments);

#endif
