/* fuzz.h - Declares the way from bytes to a program that uses the library in every way that its types allow. */
#ifndef TESTS_FUZZ_H
#define TESTS_FUZZ_H

#include <stddef.h>
#include <stdint.h>

/* Records a random function, makes an integrator with random options and makes random calls. Aborts with a message
 * where a call succeeds with a value that is not finite, or fails and has changed t, q or p. Returns how many steps
 * succeeded. */
long fuzz_one(const uint8_t data[], size_t size);

#endif
