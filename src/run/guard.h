/* guard.h - whether a step that was solved is one to return (tvi_options.max_tail). */
#ifndef TVI_SRC_RUN_GUARD_H
#define TVI_SRC_RUN_GUARD_H

#include "run/integrator.h"

#include <math.h>

/* Where a member's run begins: the state whose energy its steps are to keep. It is computed when a step first asks for
 * it, or here where every step does. */
void tvi_guard_begin(tvi_integrator *integrator, int member);

/* Which steps need no look at their energies. */
tvi_sure tvi_guard_sure(const tvi_integrator *integrator);

/* After the stepper's step, with its increments, tails and passes, before it is added to the states: the members that
 * are TVI_OK and whose tail or energy says that the step is too large become TVI_ETOOLARGE. */
void tvi_guard_step(tvi_integrator *integrator, bool took_series);

#endif
