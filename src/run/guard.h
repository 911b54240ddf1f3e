/* guard.h - Decides whether a solved step is returned or refused as too large (tvi_options.max_tail). step.c calls
 * it. */
#ifndef TVI_SRC_RUN_GUARD_H
#define TVI_SRC_RUN_GUARD_H

#include "run/integrator.h"

/* The limits up to which steps need no check of their energies. */
tvi_unchecked_step_limits tvi_guard_unchecked_step_limits(const tvi_integrator *integrator);

/* Sets TVI_ETOOLARGE for the members that are TVI_OK and whose tail or energy says that the step is too large. It is
 * called after the stepper's step, before the increments are added to the states. */
void tvi_guard_step(tvi_integrator *integrator, bool step_used_series);

#endif
