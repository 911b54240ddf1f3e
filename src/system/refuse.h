/* refuse.h - Sets texts of tvi_last_error for refusals that several functions share. Each function returns the status
 * that its caller is to return. */
#ifndef TVI_SRC_SYSTEM_REFUSE_H
#define TVI_SRC_SYSTEM_REFUSE_H

#include "refusal.h"
#include "tvi.h"

/* The arguments that all functions of a run have: the addresses of the integrator and of the state, and the step. */
typedef struct {
    const void *integrator, *t, *q, *p;
    double h; /* The step; a function without a step sets any number but 0. */
} tvi_run_arguments;

/* Refuses the arguments of a run with TVI_EINVAL. The text names the pointer that is NULL, or says what is wrong
 * with h; otherwise it is `other_reason`. */
tvi_status tvi_refuse_run_arguments(tvi_run_arguments arguments, const char *other_reason);
/* Refuses with TVI_EINVAL. The text names the first of `count` pointers that is NULL. */
tvi_status tvi_refuse_null_pointer(int count, const void *const pointer[], const char *const name[]);
/* Refuses a state that is not finite with TVI_ENONFINITE. The text names t, or the component of q [n] or
 * of the vector [n] with the name `vector_name`. Returns TVI_OK if all numbers are finite. */
tvi_status tvi_refuse_nonfinite_state(int n, double t, const double q[], const char *vector_name,
                                      const double vector[]);
/* Sets the text for a status other than TVI_OK that an evaluation has returned. `evaluated` names what was evaluated.
 * After a sweep that failed, the text also names the operation. */
tvi_status tvi_refuse_failed_evaluation(const char *evaluated, tvi_status status);

#endif
