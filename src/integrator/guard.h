/* guard.h - Decides whether a step whose equations are solved is accepted, or refused as too large for the orbit, by
 * its tail and by the change of the energy (guard.c; tvi_options.max_tail). step.c calls it. */
#ifndef TVI_INTEGRATOR_GUARD_H
#define TVI_INTEGRATOR_GUARD_H

#include "integrator/integrator.h"

/* Returns the largest tail (tvi_stats.tail) and the largest number of corrector passes with which a step is accepted
 * without computing its energy. */
tvi_unchecked_step_limits tvi_guard_unchecked_limits(const tvi_integrator *integrator);

/* Refuses a step whose tail or energy shows that it is too large (TVI_ETOOLARGE). step.c calls this function after the
 * stepper's step, before the increments are added to the state. step_used_series tells whether the step expanded a
 * Taylor series; its passes then contract faster. Keeps the energy at the end, if it was computed, and the largest tail
 * and defect (tvi_stats). */
TVI_NODISCARD tvi_status tvi_refuse_too_large_step(tvi_integrator *integrator, bool step_used_series, long passes);

/* Sets it->guard.end to the state at the end of the step, without low-order parts. */
void tvi_set_step_end(tvi_integrator *integrator);

/* Returns the largest defect of the bodies of a step (defect.c), or 0 if the system is not known to be of bodies, or
 * the stepper has no nodes. INFINITY: the forces have no finite value at an end of the
 * step. */
double tvi_defect_of_bodies(tvi_integrator *integrator);

#endif
