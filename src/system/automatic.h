/* automatic.h - the time scale of a system whose user gives none. */
#ifndef TVI_SRC_SYSTEM_AUTOMATIC_H
#define TVI_SRC_SYSTEM_AUTOMATIC_H

#include "system/system.h"

/* Of H, recorded in the inputs q, t, p, e of K. Poison where it has no value anywhere. */
jet tvi_automatic_scale(const tvi_system *base, jet H);

#endif
