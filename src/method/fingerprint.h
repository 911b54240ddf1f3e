/* fingerprint.h - what decides a step, in 64 bits: whoever keeps what belongs to a system and a method beyond their
 * life asks by these whether it belongs to the ones at hand. */
#ifndef TVI_SRC_METHOD_FINGERPRINT_H
#define TVI_SRC_METHOD_FINGERPRINT_H

#include "system/system.h"

#include <stdint.h>

/* The form, the masses, and all that the tapes of the field do: not the energy. */
uint64_t tvi_system_fingerprint(const tvi_system *system);

/* Every field of the options, as they are: those of an integrator are resolved. */
uint64_t tvi_options_fingerprint(const tvi_options *options);

#endif
