/* refuse.h - Sets texts of tvi_last_error for refusals that several functions share. All functions return the
 * status. */
#ifndef TVI_SRC_SYSTEM_REFUSE_H
#define TVI_SRC_SYSTEM_REFUSE_H

#include "refusal.h"
#include "tvi.h"

/* The arguments that all functions of a run have. */
typedef struct {
    const void *integrator, *t, *q, *p;
    double h; /* The step; a function without a step sets any number but 0. */
} tvi_run_arguments;

/* Refuses the arguments of a run with TVI_EINVAL. The text names the pointer that is NULL, or says what is wrong
 * with h; otherwise it is `other`. */
tvi_status tvi_refuse_run_arguments(tvi_run_arguments arguments, const char *other);
/* Refuses with TVI_EINVAL. The text names the first of `count` pointers that is NULL. */
tvi_status tvi_refuse_null_pointer(int count, const void *const pointer[], const char *const name[]);
/* Refuses a state that is not finite with TVI_ENONFINITE. The text names the component of t, q [n] or the vector
 * `other` [n], which is called `name`. Returns TVI_OK if all are finite. */
tvi_status tvi_refuse_nonfinite_state(int n, double t, const double q[], const char *name, const double other[]);
/* Sets the text for a status that the evaluation of `what` has returned. After a sweep that failed, it names the
 * operation. TVI_OK is returned as it is. */
tvi_status tvi_refuse_failed_evaluation(const char *what, tvi_status status);

#endif
