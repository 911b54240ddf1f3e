/* trial.h - trial steps: what they say of the error at the end of a run (trial.c). */
#ifndef TVI_SRC_RUN_TRIAL_H
#define TVI_SRC_RUN_TRIAL_H

#include "run/pair.h"

#include <math.h>

/* A trial step is a step and two of half its size. So many steps are made, the scout's included, or the part of the run
 * that stays below 5 % where the run turns out shorter than it was said to be, and at most MOST_STEPS. */
enum { TVI_STEPS_OF_TRIAL = 3, TVI_LEAST_STEPS = 20 * TVI_STEPS_OF_TRIAL, TVI_MOST_STEPS = 6000 };
#define TVI_PART_OF_RUN 0.04
/* A trial goes on while what it says is within this factor of what is aimed at. */
#define TVI_TRIAL_BAND 30.0
/* A trial of this part of the longest one knows as much. */
#define TVI_AS_LONG 0.8

/* What all trials share. */
typedef struct {
    double t, duration, aim;
    bool is_driven;
    double growth; /* of errors: a power of the time */
    double floor;  /* errors of a trial below it are roundoff */
    tvi_pair pair;
    tvi_scout scout;
    double way, weight;  /* of the run: how long it is as the scout counts it, and its weight */
    double from;         /* the place where the last trial began, and */
    const double *state; /* [2n + 1] its q, p and t */
    long kept;           /* steps, for the companion */
    double run;          /* steps of the run, with the h at hand */
    double longest;      /* part of the run that one has said something of */
} tvi_trials;

typedef struct {
    double h, part;            /* of the run's error */
    double place;              /* where it ends */
    double seen;               /* the part of the duration that lies before that */
    double now, before;        /* the largest distances in the last two octaves of its steps, 2^i + 1 ... 2^(i+1) */
    double error;              /* said of the end of the run; INFINITY: of no order, or the trial failed */
    bool has_passed;           /* the hardest place */
    bool is_over, is_complete; /* it has nothing more to say; it is the whole run */
    tvi_status status;
} tvi_trial;

/* Makes one with steps of h. */
tvi_trial tvi_trial_make(tvi_trials *trials, double h);

/* The steps that the cost allows; whether so many more; another trial step, beside what is kept; and a trial with steps
 * of h that passes the hardest place. */
static inline double tvi_trials_most(const tvi_trials *w)
{
    return fmin(fmax(TVI_LEAST_STEPS, TVI_PART_OF_RUN * w->run), TVI_MOST_STEPS);
}
static inline bool tvi_trials_may_make(const tvi_trials *w, double steps)
{
    return (double)w->pair.made + steps <= tvi_trials_most(w);
}
static inline bool tvi_trials_may_go_on(const tvi_trials *w)
{
    return tvi_trials_may_make(w, (double)(w->kept + TVI_STEPS_OF_TRIAL));
}
bool tvi_trials_may_pass(const tvi_trials *trials, double h);

/* What a trial says is that much too small or too large for another one to be asked, or above an error. */
static inline bool tvi_trial_is_above(const tvi_trials *w, const tvi_trial *r, double error)
{
    return r->error > error && (r->error == INFINITY || fmax(r->now, r->before) >= w->floor);
}
static inline bool tvi_trial_is_low(const tvi_trials *w, const tvi_trial *r)
{
    return r->error < w->aim / TVI_TRIAL_BAND;
}
static inline bool tvi_trial_is_high(const tvi_trials *w, const tvi_trial *r)
{
    return tvi_trial_is_above(w, r, TVI_TRIAL_BAND * w->aim);
}

#endif
