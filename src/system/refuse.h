/* refuse.h - Sets texts of tvi_last_error for refusals that several functions share. Each function returns the status
 * that its caller is to return. */
#ifndef TVI_SRC_SYSTEM_REFUSE_H
#define TVI_SRC_SYSTEM_REFUSE_H

#include "graph.h"
#include "refusal.h"
#include "tvi.h"

/* The arguments that all functions of a run have: the addresses of the integrator and of the state (t, q, p), and the
 * step size h. */
typedef struct {
    const void *integrator, *t, *q, *p;
    double h; /* The step size; a function without the argument h sets 1. */
} tvi_run_arguments;

/* Refuses a call whose arguments are not valid, and returns TVI_EINVAL. The text names the first pointer that is NULL.
 * If none is NULL, it says that h is 0 or not finite; if h is valid, it is `other_reason`. */
tvi_status tvi_refuse_invalid_run_arguments(tvi_run_arguments arguments, const char *other_reason);
/* Refuses a call with a NULL pointer, and returns TVI_EINVAL. The text names the first of the `count` pointers that is
 * NULL. */
tvi_status tvi_refuse_first_null_pointer(int count, const void *const pointer[], const char *const name[]);
/* Refuses a state that is not finite with TVI_ENONFINITE. The text names t, or the component of q [n] or
 * of the vector [n] with the name `vector_name`. Returns TVI_OK if all numbers are finite. */
tvi_status tvi_refuse_nonfinite_state(int n, double t, const double q[], const char *vector_name,
                                      const double vector[]);
/* Refuses masses [n] that are not finite (TVI_ENONFINITE) or not positive (TVI_EINVAL). NULL stands for masses of 1. */
tvi_status tvi_refuse_masses(int n, const double mass[]);
/* Sets the text for a status other than TVI_OK that an evaluation has returned. `evaluated_quantity` is the name of the
 * quantity for the text. If the status is TVI_EDOMAIN, the text also names the operation that failed. */
tvi_status tvi_refuse_failed_evaluation(const char *evaluated_quantity, tvi_status status);

/* The vectors [n] of jets that a user's function gets are padded: behind their end stand poison jets, as many again as
 * n, and VECTOR_PADDING_MIN at least. A function that reads a component beyond the last one is refused, since its
 * result is poison. */
enum { VECTOR_PADDING_MIN = 8 };
/* Returns the number of jets of a padded vector [n]. */
static inline size_t tvi_padded_vector_count(int n)
{
    return (size_t)n + (size_t)(n > VECTOR_PADDING_MIN ? n : VECTOR_PADDING_MIN);
}
/* Sets the padding of x [n]. The reason says which vector x is: JET_BEYOND_Q, JET_BEYOND_V or JET_BEYOND_P. */
void tvi_set_poison_beyond_end(int n, jet x[], jet_reason reason);
/* Returns a padded copy of x [n], which the caller frees, or NULL if memory is lacking. */
jet *tvi_copy_with_poison_beyond_end(int n, const jet x[], jet_reason reason);
/* Returns a padded vector of outputs [n], such as a force, whose jets are all jet_make_unset_poison(). The caller frees
 * it. It is NULL if memory is lacking. */
jet *tvi_create_unset_outputs(int n);
/* Refuses such a vector with this name, with TVI_EINVAL, if the user's function has set its padding. */
tvi_status tvi_refuse_outputs_beyond_end(const char *name, int n, const jet output[]);

#endif
