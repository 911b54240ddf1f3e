/* guard.h - whether a step that was solved is one to return (tvi_options.max_tail). */
#ifndef TVI_SRC_RUN_GUARD_H
#define TVI_SRC_RUN_GUARD_H

#include "run/integrator.h"

/* Where a run begins: the energy that its steps are to keep. */
void tvi_guard_begin(tvi_integrator *integrator);
/* After the stepper's step from integrator->now, with its increments; before: the stats before it. TVI_ETOOLARGE. */
TVI_NODISCARD tvi_status tvi_guard_step(tvi_integrator *integrator, const tvi_stats *before);

#endif
