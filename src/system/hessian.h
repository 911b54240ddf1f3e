/* hessian.h - Records the second derivatives of a Lagrangian, and of a product K = g h where they are cheap.
 * statement.c calls it. */
#ifndef TVI_SRC_SYSTEM_HESSIAN_H
#define TVI_SRC_SYSTEM_HESSIAN_H

#include "system/system.h"

/* Records the second derivatives into the system's open graph. *jets [2n + system->hessian_entries] has the field, then
 * these. It is to be freed, whatever the status. */
TVI_NODISCARD tvi_status tvi_hessian_record(tvi_system *system, jet **jets);

/* Records the second derivatives of the product K = g h, factor = {g, h}, on solutions with h = 0. If K'' costs too
 * much, it records g h'' + g' h'^T + h' g'^T, without h g''; if that does, too, it records none. */
TVI_NODISCARD tvi_status tvi_hessian_record_rescaled(tvi_system *system, const jet factor[2], jet **jets);

/* Makes the tape of the second derivatives, if there are any. The graph is closed. */
TVI_NODISCARD tvi_status tvi_hessian_lower(tvi_system *system, const jet jets[]);

#endif
