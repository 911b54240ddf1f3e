/* refuse.h - the texts of tvi_last_error that several functions share. All return the status. */
#ifndef TVI_SRC_SYSTEM_REFUSE_H
#define TVI_SRC_SYSTEM_REFUSE_H

#include "refusal.h"
#include "tvi.h"

/* The arguments that a run begins with. */
typedef struct {
    const void *integrator, *t, *q, *p;
    double h; /* not 0 where there is none */
} tvi_run_arguments;

/* TVI_EINVAL: what of these is NULL, what is wrong with h, or else the other reason. */
tvi_status tvi_refuse_run(tvi_run_arguments given, const char *other);
/* TVI_EINVAL: the first of so many pointers that is NULL, by its name. */
tvi_status tvi_refuse_null(int count, const void *const pointer[], const char *const name[]);
/* TVI_ENONFINITE: what of t, q[n] and the other vector is not finite. */
tvi_status tvi_refuse_state(int n, double t, const double q[], const char *name, const double other[]);
/* What failed where no more is known: the text of the status; where a sweep did, that of its operation. TVI_OK goes
 * through. */
tvi_status tvi_refuse_as(const char *what, tvi_status status);

#endif
