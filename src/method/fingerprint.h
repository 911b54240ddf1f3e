/* fingerprint.h - Computes a hash in 64 bits of all that decides a step. Saved states and generated code compare it
 * with the system and the method at hand. */
#ifndef TVI_SRC_METHOD_FINGERPRINT_H
#define TVI_SRC_METHOD_FINGERPRINT_H

#include "system/system.h"

#include <stdint.h>

/* A hash of the form, the masses, and all operations of the field's tapes, without the energy. */
uint64_t tvi_system_fingerprint(const tvi_system *system);

/* A hash of every field of the options; those of an integrator are resolved. */
uint64_t tvi_options_fingerprint(const tvi_options *options);

#endif
