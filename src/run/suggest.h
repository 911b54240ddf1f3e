/* suggest.h - Suggests a step size for a wanted error at the end of a run (suggest.c). tvi_suggest_step and a benchmark
 * call it. */
#ifndef TVI_SRC_RUN_SUGGEST_H
#define TVI_SRC_RUN_SUGGEST_H

#include "tvi.h"

/* A suggested step size, and the trial that it rests on. */
typedef struct {
    double h;               /* the step size that tvi_suggest_step returns */
    double trial_step_size; /* the step size of the trial on which the suggestion rests */
    /* The share of the run's expected error, 0 to 1, that arises in the part of the orbit in that trial. */
    double run_error_fraction;
    double estimated_error;   /* the error at the end of a run with trial_step_size */
    double explored_fraction; /* the part of the run's duration that was explored, 0 to 1 */
    /* The number of steps that the scout (scout.h) and all trials have tried, including those of size h/2. */
    long step_count_spent_on_search;
} tvi_step_suggestion;

/* Computes the suggestion of tvi_suggest_step for a run from the state (t, q, p), with its details. */
TVI_NODISCARD tvi_status tvi_compute_step_suggestion(const tvi_system *system, const tvi_options *options, double t,
                                                     const double q[], const double p[], double duration,
                                                     double wanted_error, tvi_step_suggestion *suggestion);

#endif
