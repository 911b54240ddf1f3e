/* guard.h - Decides whether a step whose equations are solved is accepted, or refused as too large for the orbit, by
 * its tail and by the change of the energy (guard.c; tvi_options.max_tail). step.c calls it. */
#ifndef TVI_SRC_RUN_GUARD_H
#define TVI_SRC_RUN_GUARD_H

#include "run/integrator.h"

/* Returns the largest tail (tvi_stats.tail) and the largest number of corrector passes with which a step is accepted
 * without computing its energy. */
tvi_limits_for_skipping_energy_check tvi_max_tail_and_passes_without_energy_check(const tvi_integrator *integrator);

/* Sets the status TVI_ETOOLARGE for the members with the status TVI_OK whose tail or energy shows that the step is too
 * large. step.c calls this function after the stepper's step, before the increments are added to the states.
 * step_used_series tells whether the step expanded a Taylor series; its passes then contract faster. */
void tvi_refuse_too_large_steps(tvi_integrator *integrator, bool step_used_series);

#endif
