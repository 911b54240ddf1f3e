/* guard.h - whether a step that was solved is one to return (tvi_options.max_tail). */
#ifndef TVI_SRC_RUN_GUARD_H
#define TVI_SRC_RUN_GUARD_H

#include "run/integrator.h"

#include <math.h>

/* Where a run begins: the state whose energy its steps are to keep. It is computed when a step first asks for it, or
 * here where every step does. */
void tvi_guard_begin(tvi_integrator *integrator);
/* The energy there; 0: it is not known. */
static inline void tvi_guard_set_scale(tvi_kept_energy *kept, double H)
{
    kept->scale = fabs(H);
    kept->has_scale = true;
}

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

/* After the stepper's step from integrator->start, with its increments, and so many passes and expansions before it.
 * TVI_ETOOLARGE. */
TVI_NODISCARD tvi_status tvi_guard_step(tvi_integrator *integrator, long passes, long expansions);

#endif
