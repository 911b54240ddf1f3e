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

/* The functions of a curve that are compiled for one instruction set. The functions whose names end in of_members make
 * the steps of several members at once; all other functions handle one member. */
typedef struct {
    void (*rescale_and_sum)(tvi_curve *curve, double factor, double dq[], double du[]);
    tvi_status (*compute_seeds)(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[]);
    tvi_quick_step_fn *quick_step, *quick_step_of_members;
    tvi_quick_step_fn *taylor_step_of_members;
    const tvi_closure_solver *matrix_free_solver;
} tvi_curve_isa_functions;
extern const tvi_curve_isa_functions tvi_curve_isa_functions_base, tvi_curve_isa_functions_avx2,
    tvi_curve_isa_functions_avx512;
const tvi_curve_isa_functions *tvi_choose_curve_isa_functions(const jet_tape *tape);

typedef struct tvi_curve_workspace {
    tvi_closure closure;
    bool has_end_corrections; /* whether the method corrects the ends of the curve by a generating function */
    bool needs_extra_pass;    /* whether each step makes one pass more than seems needed (newton.h) */
    const tvi_options *options;
    int q_degree;
    tvi_action action;
    tvi_newton newton;
    tvi_legendre legendre;
    /* The weights of the Q_k for the difference q- - Q_0 of the coordinates at the start and at the centre. */
    tvi_combination q_start_minus_centre_weights;
    /* The weights of the coefficients of the curve that starts at (q0, p0), for q and tau v (of a Hamiltonian p) at the
     * centre. */
    tvi_combination q_at_centre_weights, velocity_at_centre_weights;
    /* The weights of the Q_k for tau v at the end of a Lagrangian's step. */
    tvi_combination scaled_end_velocity_weights;
    /* The weights for the increments of q and of u from the start of the step to one point of dense output. */
    tvi_combination dense_output_q_weights, dense_output_u_weights;
    double *predicted_state; /* [2n] the predicted centre state */
    /* [n] of a Lagrangian: the first guess of the velocity in the next predictor; part of the history. */
    double *velocity_guess;
    double *last_adapted_step_size; /* [width] the size of each member's last adapted step, or 0; part of the history */
    double *end_field_block;        /* of separable systems: the block of the field at the end of an adapted step */
    tvi_roundoff_estimator end_field_roundoff; /* the roundoff of the field at the end of an adapted step */
    double tolerance, log_tolerance;           /* the tolerance of the last adapted step, and its logarithm */
    double *scratch;                           /* [n] scratch: one vector */
    tvi_increment_refinement refinement;
    tvi_quick_step_fn *quick_step; /* makes a whole step faster (curve_step.h); NULL if the method has none */
    const struct tvi_member_stepper *single_stepper; /* only in batches: makes the step of a single member */
} tvi_curve_workspace;

/* Allocates the workspace of `width` members. */
void *tvi_curve_workspace_allocate(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width);
/* Fills the tables of the workspace; it is called once. */
void tvi_curve_workspace_fill_tables(void *work);

/* Returns whether the method has a quick step (curve_step.h): its ends are corrected by tvi_correct_ends_by_mean, its
 * matrices are small, and its seeds need no second derivatives. */
bool tvi_has_quick_step(const tvi_system *system, const tvi_options *options);
/* Returns the quick step, or NULL if there is none. */
tvi_quick_step_fn *tvi_choose_quick_step(const tvi_closure *closure, const tvi_options *options);
/* Tells whether the curve of a step of size h satisfies the equation of motion dp/ds = h F at its end, with the force F
 * and the scaled time s, 0 to 1 in the step. The two sides may differ by q_degree times relative_tolerance times the
 * largest momentum, or by the roundoff of F. The coefficients at the start do not show a force that the body meets only
 * within the step. */
bool tvi_curve_matches_force_at_end(tvi_curve_workspace *work, double relative_tolerance, double h,
                                    const tvi_step_origin *origin, const tvi_increments *increments);

#endif
