/* tangent.h - Multiplies tangent vectors by the Jacobian matrix of a step (docs/method.md section 10). run.c and
 * times.c call it. The method makes a step of the lifted system, whose state is the
 * orbit's state together with one tangent vector. */
#ifndef TVI_INTEGRATOR_TANGENT_H
#define TVI_INTEGRATOR_TANGENT_H

#include "integrator/integrator.h"

/* Tangent vectors, the columns of a matrix [2n + parameters][count], whose rows belong to q, p and the parameters. Two
 * neighbouring elements of a row are element_spacing numbers apart in memory. */
typedef struct {
    double *elements;
    int count;
    size_t element_spacing;
    /* They are moved several at once (columns.h), and not each by itself; element_spacing is then 1. */
    bool are_moved_together;
} tvi_tangent_columns;

/* The tangent vectors of a run before and after its last step. Points inside the step are computed from those before
 * it. All is 0 before the first step. */
typedef struct {
    double *at_start, *at_end; /* [2n + parameters][columns], n that of the user's system */
    int capacity;              /* the number of columns for which both matrices have memory */
    long step_number;          /* the number of the step that the matrices belong to; 0 if there is none */
    int propagated_count;      /* the number of columns that were propagated by that step */
} tvi_step_columns;
/* Exchanges the columns of the integrator's last step with others. The integrator has memory for tangent vectors. */
void tvi_step_columns_exchange(tvi_integrator *integrator, tvi_step_columns *columns);
void tvi_step_columns_free(tvi_step_columns *columns);

/* Refuses tangent vectors that have an element which is not finite. */
TVI_NODISCARD tvi_status tvi_columns_check_finite(const tvi_integrator *integrator, const tvi_tangent_columns *columns);
/* The functions below update the columns of a run (run.c, times.c). A run without tangent vectors has
 * columns->elements = NULL; all of them then do nothing. */

/* Allocates the memory for the columns of a run, or refuses them. */
TVI_NODISCARD tvi_status tvi_columns_allocate(tvi_integrator *integrator, const tvi_tangent_columns *columns);
/* Prepares a run: stores the user's columns as those from which the first step starts. */
void tvi_columns_store_run_start(const tvi_integrator *integrator, const tvi_tangent_columns *columns);
/* Multiplies the columns by the Jacobian matrix of the integrator's last step. On failure the columns are unchanged. */
TVI_NODISCARD tvi_status tvi_columns_propagate_by_step(const tvi_integrator *integrator,
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
