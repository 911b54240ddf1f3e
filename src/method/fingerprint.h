/* fingerprint.h - Computes 64-bit hashes of everything that determines a step. Saved states and generated code store
 * them, to recognise the system and the method for which they were made. */
#ifndef TVI_SRC_METHOD_FINGERPRINT_H
#define TVI_SRC_METHOD_FINGERPRINT_H

#include "system/system.h"

#include <stdint.h>

/* Returns a hash of the form, the masses, and all operations of the field's tapes. The energy is left out. */
uint64_t tvi_system_fingerprint(const tvi_system *system);

/* Returns a hash of every field of the options except `compiled`. The options of an integrator are resolved. */
uint64_t tvi_options_fingerprint(const tvi_options *options);

#endif
