/* step_doubling.h - Steps two orbits side by side, and measures their distance, for trials of a step size (trial.c). */
#ifndef TVI_SRC_RUN_STEP_DOUBLING_H
#define TVI_SRC_RUN_STEP_DOUBLING_H

#include "run/scout.h"
#include "system/rates.h"

#include <stdbool.h>

typedef struct {
    int n;
    bool is_rescaled;
    tvi_scout_orbit full, halved; /* the orbits with steps h and h/2 */
    double size_q, size_p;        /* the largest coordinate and momentum */
    tvi_rates rates;              /* of a rescaled system */
    double *x, *rate;             /* [2n + 1] a state of `full`, [2n] its rates */
    double *states;               /* of the scout */
    double fastest;               /* the largest rate so far, relative to the sizes */
    double distance;              /* the distance when it was measured last */
    long steps_tried;             /* of both orbits */
    bool lacks_memory;            /* a step failed for lack of memory */
} tvi_step_doubling;

/* Open and close. A structure of zeros may be closed, too. */
TVI_NODISCARD tvi_status tvi_step_doubling_open(tvi_step_doubling *pair, const tvi_system *system,
                                                const tvi_options *options);
void tvi_step_doubling_close(tvi_step_doubling *pair);

/* Sets both orbits to the state [2n + 1]: q, p and t. */
void tvi_step_doubling_begin(tvi_step_doubling *pair, const double *state);

/* Makes one step of size h, and two of size h/2. */
TVI_NODISCARD tvi_status tvi_step_doubling_advance(tvi_step_doubling *pair, double h);

/* Makes a step of size h from the state, and another one from the same state at a time later by shift. *apart is the
 * distance of their ends; 0 if a step fails. Returns TVI_ENOMEM or TVI_OK. */
TVI_NODISCARD tvi_status tvi_step_doubling_shift(tvi_step_doubling *pair, const double *state, double h, double shift,
                                                 double *apart);

/* Measures `apart`, the largest difference of a coordinate or a momentum, relative to the sizes. Steps of a rescaled
 * orbit may have a large error along the orbit that shows where the motion is fast. The return value is the distance
 * there, if it is larger. */
double tvi_step_doubling_distance(tvi_step_doubling *pair);

/* The factor from the error that a trial measures between two positions to the error of a run. It sums, over all that
 * the scout saw, the part of the error made at each position times its growth to the end, relative to the trial's own
 * part. The companion measures the growth: it starts beside the position next to the trial's end, in the direction of
 * the error there. `from` is a position of the scout. 0: there was no companion. *growth is the ratio of the largest
 * distances in the second and in the first half of the companion's way. */
double tvi_step_doubling_growth(tvi_step_doubling *pair, const tvi_scout *scout, double from, double to,
                                double *growth);

#endif
