/* automatic.h - Records the time scale of a system whose user gives none, for rescaled.c. */
#ifndef TVI_SRC_SYSTEM_AUTOMATIC_H
#define TVI_SRC_SYSTEM_AUTOMATIC_H

#include "system/system.h"

/* Records g for H in the inputs q, t, p, e of K. The result is poison if g has no value anywhere. */
jet tvi_automatic_scale(const tvi_system *base, jet H);

#endif
