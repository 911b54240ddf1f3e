/* pair.h - two orbits beside one another, and how far they are apart (pair.c). */
#ifndef TVI_SRC_RUN_PAIR_H
#define TVI_SRC_RUN_PAIR_H

#include "run/scout.h"
#include "system/rates.h"

#include <stdbool.h>

typedef struct {
    int n;
    bool is_rescaled;
    tvi_orbit whole, halves; /* of steps h and h/2 */
    double size_q, size_p;   /* the largest coordinate and momentum */
    tvi_rates rates;         /* of a rescaled system, with */
    double *x, *rate;        /* [2n + 1], [2n], at whole */
    double *states;          /* for a scout */
    double fastest;          /* of its rates, relative to the sizes */
    double apart;            /* the distance when last measured */
    long made;               /* steps of both */
    bool lacks_memory;       /* where that failed one */
} tvi_pair;

/* Opens and closes; what was not opened is closed too. */
TVI_NODISCARD tvi_status tvi_pair_open(tvi_pair *pair, const tvi_system *system, const tvi_options *options);
void tvi_pair_close(tvi_pair *pair);

/* Both orbits at state, [2n + 1]: q, p and t. */
void tvi_pair_begin(tvi_pair *pair, const double *state);

/* By one step of h, and by two of h/2. */
TVI_NODISCARD tvi_status tvi_pair_advance(tvi_pair *pair, double h);

/* A step of h from state, and the same at a time that is later by shift: how far apart they end. TVI_ENOMEM; where a
 * step fails, 0. */
TVI_NODISCARD tvi_status tvi_pair_shift(tvi_pair *pair, const double *state, double h, double shift, double *apart);

/* The largest distance of a coordinate or momentum, relative to the sizes; apart is set to it. A rescaled orbit is fast
 * at some places, where steps may miss what is along it: returns how far the orbits would be apart there, if that is
 * more. */
double tvi_pair_distance(tvi_pair *pair);

/* What an error makes of a run of which a trial knows the part between two places: the sum of all that the scout saw,
 * each place's part of the error times how much farther it is apart at the end than there, relative to the trial's own
 * part. The companion of the scout that tells it begins beside the place next to the trial's end, in the direction in
 * which the pair is apart. from is a place of the scout. 0: none could be sent. *growth: how many times as far apart
 * they were in the second half of its way as in the first. */
double tvi_pair_stretch(tvi_pair *pair, const tvi_scout *scout, double from, double to, double *growth);

#endif
