/* thorough.h - asks how much a test does: make check has a share of what only guards rare things, and make check-long
 * (check-thorough) has all of it. */
#ifndef TESTS_PROBLEMS_THOROUGH_H
#define TESTS_PROBLEMS_THOROUGH_H

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Whether the environment has TVI_TESTS=all. */
static inline bool is_thorough(void)
{
    const char *how = getenv("TVI_TESTS");
    return how && strcmp(how, "all") == 0;
}

#endif
