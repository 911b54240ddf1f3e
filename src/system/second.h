/* second.h - the second derivatives of a Lagrangian, and of a product K = g h where they are cheap. */
#ifndef TVI_SRC_SYSTEM_SECOND_H
#define TVI_SRC_SYSTEM_SECOND_H

#include "system/system.h"

/* Records them into the system's open graph: *jets [2n + system->seconds] has the field, then them, and is to be freed,
 * whatever the status. */
TVI_NODISCARD tvi_status tvi_second_record(tvi_system *system, jet **jets);

/* Of the product K = g h, factor = {g, h}, on solutions where h is 0. Where K'' is too dear, that is g h'' + g' h'^T +
 * h' g'^T, without h g''; where that is, too, there is nothing. */
TVI_NODISCARD tvi_status tvi_second_record_product(tvi_system *system, const jet factor[2], jet **jets);

/* Makes their tape, if there are any, the graph closed. */
TVI_NODISCARD tvi_status tvi_second_lower(tvi_system *system, const jet jets[]);

#endif
