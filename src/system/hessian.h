/* hessian.h - Records the second derivatives of a Lagrangian, and those of a rescaled Hamiltonian K = g h if they
 * are cheap. statement.c calls it. */
#ifndef TVI_SRC_SYSTEM_HESSIAN_H
#define TVI_SRC_SYSTEM_HESSIAN_H

#include "system/system.h"

/* Records the second derivatives into the system's open graph. *jets [2n + hessian_entries] becomes the field,
 * followed by the derivatives. The caller frees it, whatever the status. */
TVI_NODISCARD tvi_status tvi_hessian_record(tvi_system *system, jet **jets);

/* Records the second derivatives of K = g h, factor = {g, h}, for solutions with h = 0. If all of K'' is too
 * expensive, it records g h'' + g' h'^T + h' g'^T, which leaves out h g''. If that is too expensive, it records
 * none. */
TVI_NODISCARD tvi_status tvi_hessian_record_of_product(tvi_system *system, const jet factor[2], jet **jets);

/* Creates the tape of the second derivatives if there are any. The graph must be closed. */
TVI_NODISCARD tvi_status tvi_hessian_create_tape(tvi_system *system, const jet jets[]);

#endif
