/* guard.h - whether a step that was solved is one to return (tvi_options.max_tail). */
#ifndef TVI_SRC_RUN_GUARD_H
#define TVI_SRC_RUN_GUARD_H

#include "run/integrator.h"

/* Where a run begins: the energy that its steps are to keep. */
void tvi_guard_begin(tvi_integrator *integrator);

/* What a stepper says of its step: the tail, the passes, whether it took series, and the most that it changes the
 * energy by (stepper.h), or NULL. */
typedef struct {
    double tail;
    long passes;
    bool took_series;
    const double *most_change;
} tvi_signs;
tvi_sure tvi_guard_sure(const tvi_integrator *it);
/* The tail is one that may be: TVI_ETOOLARGE. */
TVI_NODISCARD tvi_status tvi_guard_tail(const tvi_integrator *it, double tail);
/* Whether the energy, too, is to be looked at; where it is not, the next step has to compute the one it starts from. */
bool tvi_guard_asks(const tvi_integrator *it, const tvi_signs *signs, tvi_kept_energy *kept);

/* A step from (q, p) by (dq, dp), as in tvi_run_state, with the components `stride` apart. */
typedef struct {
    int n, dimension, stride; /* the user's, the steps' */
    const double *q, *p, *dq, *dp;
} tvi_guarded;
/* Whether it is changed by what no step does, from the one that is kept, which is known, to that at the end, or what
 * was found there: outside of the domain nothing is known, and the next step says so. */
bool tvi_guard_loses(const tvi_guarded *step, tvi_kept_energy *kept, tvi_status status, double after);

/* After the stepper's step from integrator->now, with its increments; before: the stats before it. TVI_ETOOLARGE. */
TVI_NODISCARD tvi_status tvi_guard_step(tvi_integrator *integrator, const tvi_stats *before);

#endif
