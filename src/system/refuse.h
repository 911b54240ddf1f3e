/* refuse.h - Writes the texts of tvi_last_error that several functions share. All functions return the status. */
#ifndef TVI_SRC_SYSTEM_REFUSE_H
#define TVI_SRC_SYSTEM_REFUSE_H

#include "refusal.h"
#include "tvi.h"

/* The arguments that a run begins with. */
typedef struct {
    const void *integrator, *t, *q, *p;
    double h; /* any number but 0 if there is none */
} tvi_run_arguments;

/* TVI_EINVAL, with the name of the pointer that is NULL, what is wrong with h, or else the text `other`. */
tvi_status tvi_refuse_run(tvi_run_arguments given, const char *other);
/* TVI_EINVAL, with the name of the first of `count` pointers that is NULL. */
tvi_status tvi_refuse_null(int count, const void *const pointer[], const char *const name[]);
/* TVI_ENONFINITE, with the component of t, q[n] or the other vector that is not finite. */
tvi_status tvi_refuse_state(int n, double t, const double q[], const char *name, const double other[]);
/* The status, with its text. After a sweep that failed it names the operation. TVI_OK is returned as it is. */
tvi_status tvi_refuse_as(const char *what, tvi_status status);

#endif
