/* curve_stepper.h - declares the workspace of a method that expands one Taylor curve, for curve_stepper.c and
 * curve_workspace.c. */
#ifndef TVI_SRC_GENERATING_CURVE_STEPPER_H
#define TVI_SRC_GENERATING_CURVE_STEPPER_H

#include "generating/action.h"
#include "generating/corrected_curve.h"
#include "generating/newton.h"
#include "generating/refine.h"
#include "system/legendre.h"
#include "system/roundoff.h"

/* The functions of a curve that are compiled for one instruction set. */
typedef struct {
    void (*rescale_and_sum)(tvi_curve *curve, double factor, double dq[], double du[]);
    tvi_status (*compute_seeds)(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[]);
    const tvi_end_correction_solver *matrix_free_solver;
} tvi_curve_isa_functions;
extern const tvi_curve_isa_functions tvi_curve_isa_functions_base, tvi_curve_isa_functions_avx2,
    tvi_curve_isa_functions_avx512;
const tvi_curve_isa_functions *tvi_choose_curve_isa_functions(const jet_tape *tape);

typedef struct tvi_curve_workspace {
    tvi_corrected_curve corrected_curve;
    /* Whether the method corrects the ends of the curve by a generating function. */
    bool has_symplectic_end_corrections;
    bool confirms_convergence_by_extra_pass; /* whether each step makes one pass more than seems needed (newton.h) */
    const tvi_options *options;
    int q_degree;
    tvi_action action;
    tvi_newton newton;
    tvi_legendre_transform legendre_transform;
    /* The weights of the Q_k for the difference q- - Q_0 of the coordinates at the start and at the centre. */
    tvi_coefficient_combination q_start_minus_centre_weights;
    /* The weights of the coefficients of the curve that starts at (q0, p0), for q and tau v (of a Hamiltonian p) at the
     * centre. */
    tvi_coefficient_combination q_at_centre_weights, velocity_at_centre_weights;
    /* The weights of the Q_k for tau v at the end of a Lagrangian's step. */
    tvi_coefficient_combination scaled_end_velocity_weights;
    /* The weights for the increments of q and of u from the start of the step to one point of dense output. */
    tvi_coefficient_combination dense_output_q_weights, dense_output_scaled_p_weights;
    double *predicted_state; /* [2n] the predicted centre state */
    /* [n] of a Lagrangian: the first guess of the velocity in the next predictor; part of the history. */
    double *velocity_guess;
    /* The size of the last adapted step, or 0; part of the history. */
    double *last_adapted_step_size;
    /* The values of all slots of the field's tape at the end of an adapted step, if the system is separable. */
    double *field_tape_values_at_step_end;
    tvi_roundoff_estimator end_field_roundoff; /* the roundoff of the field at the end of an adapted step */
    /* The tolerance of the last adapted step, and its logarithm. */
    double adapted_step_tolerance, log_adapted_step_tolerance;
    double *scratch; /* [n] scratch: one vector */
    tvi_increment_refinement refinement;
} tvi_curve_workspace;

void *tvi_curve_workspace_allocate(tvi_arena *arena, const tvi_system *system, const tvi_options *options);
/* Fills the tables of the workspace; it is called once. */
void tvi_curve_workspace_compute_constant_tables(void *work);

/* Tells whether the curve of a step of size h satisfies the equation of motion dp/ds = h F at its end, with the force F
 * and the scaled time s, 0 to 1 in the step. The two sides may differ by q_degree times relative_tolerance times the
 * largest momentum, or by the roundoff of F. The coefficients at the start do not show a force that the body meets only
 * within the step. */
bool tvi_curve_matches_force_at_end(tvi_curve_workspace *work, double relative_tolerance, double h,
                                    const tvi_step_origin *origin, const tvi_increments *increments);

#endif
