/* allocation.h - Declares the library's malloc, calloc, realloc, aligned_alloc and free under the test's control, by
 * the linker's --wrap: counts them, and makes the k-th allocation fail. Sees the objects of the test program, not
 * shared libraries. */
#ifndef TVI_TESTS_ALLOCATION_H
#define TVI_TESTS_ALLOCATION_H

#include <stdbool.h>
#include <stddef.h>

typedef enum {
    FAIL_ONCE,  /* the k-th allocation alone */
    FAIL_ONWARD /* the k-th and all after it */
} allocation_failure;

typedef struct {
    long calls; /* of malloc, calloc, realloc and aligned_alloc */
    long fails;
    long live;    /* allocations minus frees */
    size_t bytes; /* asked for, in all */
} allocation_counts;

/* Counts anew from zero, and nothing fails. */
void allocation_count(void);
/* Counts anew, and the k-th allocation from now fails, k >= 1. */
void allocation_fail(allocation_failure how, long k);
/* The counts since then; nothing fails any more. */
allocation_counts allocation_stop(void);

#endif
