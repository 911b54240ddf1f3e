/* hessian.h - Records the second derivatives of a Lagrangian, and those of a rescaled Hamiltonian K = g f if they
 * are cheap. statement.c calls it. */
#ifndef TVI_SRC_SYSTEM_HESSIAN_H
#define TVI_SRC_SYSTEM_HESSIAN_H

#include "system/system.h"

/* Records the second derivatives into the system's open graph. *jets [2n + hessian_entries] becomes the field,
 * followed by the derivatives. The caller frees it, whatever the status. */
TVI_NODISCARD tvi_status tvi_hessian_record(tvi_system *system, jet **jets);

/* Records the second derivatives of K = g f, factor = {g, f}, for solutions with f = 0. If the complete K'' is too
 * expensive, it records g f'' + g' f'^T + f' g'^T, which leaves out f g''. If that is too expensive, it records
 * none. */
TVI_NODISCARD tvi_status tvi_hessian_record_of_product(tvi_system *system, const jet factor[2], jet **jets);

/* Creates the tape of the second derivatives if there are any. The recording must be finished (jet_graph_close). */
TVI_NODISCARD tvi_status tvi_hessian_create_tape(tvi_system *system, const jet jets[]);

#endif
