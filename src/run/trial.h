/* trial.h - Makes trials of a step size, which estimate the error at the end of a run (trial.c). suggest.c calls it. */
#ifndef TVI_SRC_RUN_TRIAL_H
#define TVI_SRC_RUN_TRIAL_H

#include "run/step_doubling.h"

#include <math.h>

/* The cost of all trials. A trial step is a step and two of half its size. The steps, the scout's included, are at most
 * TVI_PART_OF_RUN of the run's, but at least TVI_LEAST_STEPS and at most TVI_MOST_STEPS. */
enum { TVI_STEPS_OF_TRIAL = 3, TVI_LEAST_STEPS = 20 * TVI_STEPS_OF_TRIAL, TVI_MOST_STEPS = 6000 };
#define TVI_PART_OF_RUN 0.04
/* A trial goes on as long as its estimate is within this factor of the aim. */
#define TVI_TRIAL_BAND 30.0
/* A trial that covers this part of the longest one counts as much. */
#define TVI_EQUALLY_LONG 0.8

/* The state that all trials share. */
typedef struct {
    double t, duration, aim;
    bool is_driven;
    /* The power of the time with which errors grow. */
    double growth;
    /* Errors of a trial below this are roundoff. */
    double floor;
    tvi_step_doubling pair;
    tvi_scout scout;
    /* The length of the run as the scout counts it, and its weight. */
    double way, weight;
    double start_position; /* the position where the last trial began */
    const double *state;   /* [2n + 1] q, p and t at `start_position` */
    long reserve;          /* steps for the companion */
    double run;            /* steps of the run with the current h */
    double longest;        /* the largest part of the run's error that a trial covered */
} tvi_trials;

/* A trial, and its estimate. */
typedef struct {
    /* The step, and the part of the run's error that the trial covers. */
    double h, part;
    double end_position; /* where the trial ends */
    double seen;         /* the part of the duration up to its end */
    /* The largest distances in the last two octaves of steps, 2^i + 1 ... 2^(i+1). */
    double recent, previous;
    /* The estimate for the end of the run; INFINITY: it has no order, or the trial failed. */
    double error;
    bool has_passed;           /* the hardest position */
    bool is_over, is_complete; /* the trial is finished; it covers the whole run */
    tvi_status status;
} tvi_trial;

/* Makes a trial with steps of size h. */
tvi_trial tvi_trial_make(tvi_trials *trials, double h);

/* The most steps that the cost allows, and whether it allows so many more: `steps`, one more trial step beside the
 * companion's, and a trial with steps of h that passes the hardest position. */
static inline double tvi_trials_most(const tvi_trials *w)
{
    return fmin(fmax(TVI_LEAST_STEPS, TVI_PART_OF_RUN * w->run), TVI_MOST_STEPS);
}
static inline bool tvi_trials_allow(const tvi_trials *w, double steps)
{
    return (double)w->pair.steps_tried + steps <= tvi_trials_most(w);
}
static inline bool tvi_trials_allow_step(const tvi_trials *w)
{
    return tvi_trials_allow(w, (double)(w->reserve + TVI_STEPS_OF_TRIAL));
}
bool tvi_trials_allow_passage(const tvi_trials *trials, double h);

/* Tell whether the estimate is above an error, or so far below or above the aim that no other trial is asked for. */
static inline bool tvi_trial_is_above(const tvi_trials *w, const tvi_trial *r, double error)
{
    return r->error > error && (r->error == INFINITY || fmax(r->recent, r->previous) >= w->floor);
}
static inline bool tvi_trial_is_low(const tvi_trials *w, const tvi_trial *r)
{
    return r->error < w->aim / TVI_TRIAL_BAND;
}
static inline bool tvi_trial_error_is_high(const tvi_trials *w, const tvi_trial *r)
{
    return tvi_trial_is_above(w, r, TVI_TRIAL_BAND * w->aim);
}

#endif
