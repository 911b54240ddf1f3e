/* scout.h - a first look along an orbit, by few large steps (scout.c). */
#ifndef TVI_SRC_RUN_SCOUT_H
#define TVI_SRC_RUN_SCOUT_H

#include "tvi.h"

#include <stdbool.h>

/* Where an integrator is on an orbit of n coordinates. */
typedef struct {
    tvi_integrator *steps;
    double t, *q, *p;
} tvi_orbit;

/* Moves it to state, [2n + 1]: q, p and t. */
void tvi_orbit_set(tvi_orbit *orbit, int n, const double *state);

enum { TVI_SCOUT_STEPS = 24 };

/* What was seen. Places along the orbit are sums of steps, from 0, so in s where the system is rescaled. */
typedef struct {
    int n;
    double *states; /* [TVI_SCOUT_STEPS + 1][2n + 1] q, p and t at each place: the caller's memory */
    long made;      /* steps, those that failed or were taken back included */
    int count;      /* steps that were right, k = 0 ... count - 1, */
    double place[TVI_SCOUT_STEPS + 1];
    double scale[TVI_SCOUT_STEPS]; /* and what step just resolves the orbit there; the shortest is that of */
    int hardest;
    double part;           /* of the run that is behind it */
    bool is_blind;         /* the method has no tail: one step, which need not resolve anything */
    double size_q, size_p; /* the largest coordinate and momentum */
    tvi_status status;     /* of the last step */
} tvi_scout;

/* The tail of a step that just resolves the orbit. */
#define TVI_SCOUT_TAIL 0.003

/* Moves the orbit on, TVI_SCOUT_STEPS steps at most, or to the end of the run. Where no step is right, the status of
 * the last one; TVI_ENOMEM. */
TVI_NODISCARD tvi_status tvi_scout_look(tvi_scout *scout, tvi_orbit *orbit, double duration);

/* How much of the run's error is made between two places: the way there where the orbit is hardest, less elsewhere. */
double tvi_scout_weight(const tvi_scout *scout, double from, double to);

#endif
