/* tangent.h - Multiplies tangent vectors by the Jacobian matrix of a step (docs/method.md section 10). tvi_step_tangent
 * and runs with tangent vectors call it. The method makes a step of the lifted system, whose state is the
 * orbit's state together with one tangent vector. */
#ifndef TVI_SRC_RUN_TANGENT_H
#define TVI_SRC_RUN_TANGENT_H

#include "run/integrator.h"

/* A step whose Jacobian matrix is wanted: the state at its start, the parameters that it is made with, and its size. */
typedef struct {
    const tvi_run_state *start;
    const double *parameters;
    double h;
} tvi_step_to_differentiate;

/* Tangent vectors, the columns of a matrix [2n + parameters][count], whose rows belong to q, p and the parameters. Two
 * neighbouring elements of a row are element_spacing numbers apart in memory. */
typedef struct {
    double *elements;
    int count;
    size_t element_spacing;
} tvi_tangent_columns;

/* The memory of an integrator for tangent vectors. n is the number of coordinates of the system that is stepped. */
struct tvi_tangent {
    int n;                     /* coordinates of the stepped system: one more than the user's if it is rescaled */
    bool are_momenta_swapped;  /* true if the momenta of the coordinates (q, dq) are (dp, p), not (p, dp) */
    tvi_system *lifted_system; /* the lifted system, with coordinates (q, dq) */
    tvi_integrator *lifted_integrator; /* makes steps of the lifted system */
    double *lifted_q, *lifted_p;       /* [2n] each, the state of the lifted system */
    double *column;                    /* [2n + parameters] the tangent vector that is being multiplied */
    double *gradient;                  /* [2n] the derivatives K_q and K_p of a rescaled system's Hamiltonian K */
    double *field_block;  /* memory in which the tape of K_q and K_p is evaluated; NULL if the system is not rescaled */
    double *energy_block; /* memory in which the lifted energy is evaluated, the change of K along a tangent vector */
    /* [2 parameters] The parameters of the lifted system: the integrator's values, then their components of the tangent
     * vector. */
    double *parameters_and_rates;
    /* Matrices [2n + parameters][columns] of a run's tangent vectors, before and after the last step. Their n is
     * that of the user's system. */
    double *columns_at_step_start, *columns_at_step_end;
    int column_capacity;         /* the number of columns for which these matrices have memory */
    long step_number;            /* the number of the step to which they belong; 0 if there is none */
    int propagated_column_count; /* the number of columns that were propagated by this step */
};

/* Refuses tangent vectors that have an element which is not finite. */
TVI_NODISCARD tvi_status tvi_columns_check_finite(const tvi_integrator *integrator, const tvi_tangent_columns *columns);
/* Computes product = M columns, where M is the Jacobian matrix of the step. Rows of the parameters are not written.
 * The caller has allocated the integrator's memory by tvi_integrator_allocate_tangents. On failure `product` is
 * undefined. */
TVI_NODISCARD tvi_status tvi_columns_multiply_by_jacobian(const tvi_integrator *integrator,
                                                          const tvi_step_to_differentiate *step,
                                                          const tvi_tangent_columns *columns,
                                                          const tvi_tangent_columns *product);

/* The functions below update the columns of a run (run.c, times.c, locate.c). A run without tangent vectors has
 * columns->elements = NULL; all of them then do nothing. */

/* Prepares a run: stores the user's columns as those from which the first step starts. */
void tvi_columns_store_run_start(const tvi_integrator *integrator, const tvi_tangent_columns *columns);
/* Multiplies the columns by the Jacobian matrix of the integrator's last step. On failure the columns are unchanged. */
TVI_NODISCARD tvi_status tvi_columns_propagate_by_last_step(const tvi_integrator *integrator,
                                                            const tvi_tangent_columns *columns);
/* Sets the columns to those at the given offset (0 to h) from the start of the last step, which was made with the given
 * parameters. On failure the columns become those at the end of the step. */
TVI_NODISCARD tvi_status tvi_columns_propagate_to_offset(const tvi_integrator *integrator,
                                                         const tvi_tangent_columns *columns, double offset,
                                                         const double parameters[]);
/* Sets the columns to the stored ones at the end of the last step. */
void tvi_columns_restore_step_end(const tvi_integrator *integrator, const tvi_tangent_columns *columns);
/* Sets the columns to the stored ones at the start of the last step. */
void tvi_columns_restore_step_start(const tvi_integrator *integrator, const tvi_tangent_columns *columns);
/* Tells whether the user's columns equal the stored ones at the end of the last step, bit for bit. In that case the
 * columns at points inside that step can be computed. */
bool tvi_columns_match_last_step_end(const tvi_integrator *integrator, const tvi_tangent_columns *columns);

#endif
