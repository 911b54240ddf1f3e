/* automatic.h - Records an automatic time scale g for a rescaled system whose user gives none. rescaled.c calls
 * it. */
#ifndef TVI_SRC_SYSTEM_AUTOMATIC_H
#define TVI_SRC_SYSTEM_AUTOMATIC_H

#include "system/system.h"

/* Records g from H, in the graph of the rescaled Hamiltonian K, whose inputs are q, t, p and e = -H. The result is a
 * jet that makes the recording fail if g exists nowhere. */
jet tvi_record_automatic_scale(const tvi_system *base, jet H);

#endif
