/* thorough.h - Asks how much a test does: make check has a share of what only guards rare things, and make check-long
 * (check-thorough) has all of it. */
#ifndef TESTS_PROBLEMS_THOROUGH_H
#define TESTS_PROBLEMS_THOROUGH_H

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Whether the environment has this for TVI_TESTS. */
static inline bool tests_are(const char *wanted)
{
    const char *how = getenv("TVI_TESTS");
    return how && strcmp(how, wanted) == 0;
}

static inline bool is_thorough(void) { return tests_are("all"); }

/* Whether the library has no devices for speed (make check-plain), and there is nothing to test of them. */
static inline bool is_plain(void) { return tests_are("plain"); }

#endif
