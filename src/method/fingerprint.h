/* fingerprint.h - Computes 64-bit hashes of everything that determines a step. Saved states and generated code store
 * them, to recognise the system and the method for which they were made. */
#ifndef TVI_SRC_METHOD_FINGERPRINT_H
#define TVI_SRC_METHOD_FINGERPRINT_H

#include "system/system.h"

#include <stdint.h>

/* Returns a hash of the form, the masses, and all operations of the tapes of the field. The energy is left out, since
 * steps do not depend on it. */
uint64_t tvi_system_fingerprint(const tvi_system *system);

/* Returns a hash of every field of the options except `compiled`. Options that are compared must be resolved, as
 * those of an integrator are. */
uint64_t tvi_options_fingerprint(const tvi_options *options);

#endif
