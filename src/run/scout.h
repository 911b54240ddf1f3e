/* scout.h - Explores an orbit with few large steps (scout.c), for suggest.c and trial.c. */
#ifndef TVI_SRC_RUN_SCOUT_H
#define TVI_SRC_RUN_SCOUT_H

#include "tvi.h"

#include <stdbool.h>

/* An integrator, and its state on an orbit of n coordinates. */
typedef struct {
    tvi_integrator *integrator;
    double t, *q, *p;
} tvi_scout_orbit;

/* Sets the orbit to the state [2n + 1]: q, p and t. */
void tvi_scout_orbit_set(tvi_scout_orbit *orbit, int n, const double *state);

enum { TVI_SCOUT_STEPS = 24 };

/* The results of a scout. Positions along the orbit are sums of steps from 0; they are in s if the system is
 * rescaled. */
typedef struct {
    int n;
    /* [TVI_SCOUT_STEPS + 1][2n + 1] q, p and t at each position, in the caller's memory. */
    double *states;
    long steps_tried; /* also those that failed or were undone */
    int count;        /* steps that succeeded, k = 0 ... count - 1 */
    double position[TVI_SCOUT_STEPS + 1];
    double scale[TVI_SCOUT_STEPS]; /* the step that just resolves the orbit at each */
    int hardest;                   /* index of the least scale */
    double part;                   /* of the run that the scout has covered */
    bool has_no_tail;              /* one step was made, which need not resolve anything */
    double size_q, size_p;         /* the largest coordinate and momentum */
    tvi_status status;             /* of the last step */
} tvi_scout;

/* The tail of a step that just resolves the orbit. */
#define TVI_SCOUT_TAIL 0.003

/* Moves the orbit on by TVI_SCOUT_STEPS steps at most, or to the end of the run. Returns the status of the last step if
 * no step succeeds, or TVI_ENOMEM. */
TVI_NODISCARD tvi_status tvi_scout_run(tvi_scout *scout, tvi_scout_orbit *orbit, double duration);

/* A weight for the part of the run's error that is made between two positions: the distance at the hardest position,
 * less elsewhere. */
double tvi_scout_weight(const tvi_scout *scout, double from, double to);

#endif
