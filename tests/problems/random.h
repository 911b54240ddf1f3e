/* random.h - Declares numbers of a sequence that is the same in each run. */
#ifndef TESTS_PROBLEMS_RANDOM_H
#define TESTS_PROBLEMS_RANDOM_H

#include <stdint.h>

/* From 0 to 1, with all bits of a number. */
static inline double number_of(uint64_t *bits)
{
    *bits = *bits * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*bits >> 11) * 0x1p-53;
}

/* 0 to count - 1. */
static inline int whole(uint64_t *bits, int count) { return (int)(number_of(bits) * count); }

#endif
