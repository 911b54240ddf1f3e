/* end.h - Ends a run at a time: the remaining time, the shorter step that ends at it, and the parts of a step that
 * would pass it but has no solution (end.c). run.c calls it. */
#ifndef TVI_SRC_RUN_END_H
#define TVI_SRC_RUN_END_H

#include "integrator/integrator.h"

#include <float.h>

/* Returns the remaining time t_end - t, with the low-order part of the time t. */
double tvi_remaining_time(const tvi_integrator *integrator, double t_end);

/* Returns the roundoff of a remaining time, for steps of size h. */
double tvi_time_roundoff(double t, double t_end, double h);

/* Sets the time to t_end, from which it differs by roundoff alone. The difference is kept in the low-order part of the
 * time. */
void tvi_set_time(tvi_integrator *integrator, double t_end, double *t);

/* Replaces the last step, a step in s that went past t_end, by a shorter one from the same start that ends at t_end. */
TVI_NODISCARD tvi_status tvi_shorten_step_to_time(tvi_integrator *integrator, double t_end, double *t, double q[],
                                                  double p[]);

/* [k] the number of steps of size h / 2^k that are made in the place of a step of size h, in the order of k. */
typedef struct {
    int count[DBL_MANT_DIG];
} tvi_step_parts;

/* Finds the parts of the next step in s, of size h, that lead past t_end, where the step itself has failed. *is_found
 * tells whether there are such parts. */
TVI_NODISCARD tvi_status tvi_parts_find(tvi_step_parts *parts, const tvi_integrator *integrator, double h, double t_end,
                                        bool *is_found);
/* Takes the next one of the parts, and returns its size, or 0 if none is left. */
double tvi_parts_take(tvi_step_parts *parts, double h);

#endif
