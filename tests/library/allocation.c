/* allocation.c - Implements allocation.h. */
#include "allocation.h"

#include <stdlib.h>

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
void __wrap_free(void *block);

static allocation_counts counts;
static allocation_failure failure;
static long fail_at; /* 0: never */

void allocation_count(void)
{
    counts = (allocation_counts){0};
    fail_at = 0;
}

void allocation_fail(allocation_failure how, long k)
{
    allocation_count();
    failure = how;
    fail_at = k;
}

allocation_counts allocation_stop(void)
{
    fail_at = 0;
    return counts;
}

/* Counts a call; whether it has to fail. */
static bool fails(size_t bytes)
{
    counts.calls++;
    counts.bytes += bytes;
    const bool failing = fail_at > 0 && (failure == FAIL_ONCE ? counts.calls == fail_at : counts.calls >= fail_at);
    counts.fails += failing;
    return failing;
}

static void *made(void *block)
{
    counts.live += block != NULL;
    return block;
}

void *__wrap_malloc(size_t size) { return fails(size) ? NULL : made(__real_malloc(size)); }

void *__wrap_calloc(size_t count, size_t size) { return fails(count * size) ? NULL : made(__real_calloc(count, size)); }

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return fails(size) ? NULL : made(__real_aligned_alloc(alignment, size));
}

void *__wrap_realloc(void *old, size_t size)
{
    if (fails(size)) return NULL;
    return old ? __real_realloc(old, size) : made(__real_realloc(NULL, size));
}

void __wrap_free(void *block)
{
    counts.live -= block != NULL;
    __real_free(block);
}
