/* second.h - the second derivatives of a Lagrangian, and of a Hamiltonian where they are cheap. */
#ifndef TVI_SRC_SYSTEM_SECOND_H
#define TVI_SRC_SYSTEM_SECOND_H

#include "system/system.h"

/* Records them into the system's open graph: *jets [2n + system->seconds] has the field, then them, and is to be freed,
 * whatever the status. *jets NULL: there would be too many. */
TVI_NODISCARD tvi_status tvi_second_record(tvi_system *system, jet **jets);

/* Makes their tape, the graph closed; none of a Hamiltonian if it is not cheap. */
TVI_NODISCARD tvi_status tvi_second_lower(tvi_system *system, const jet jets[]);

#endif
