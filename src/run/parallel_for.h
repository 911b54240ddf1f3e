/* parallel_for.h - Runs the iterations of a loop in several threads. Ensembles call it. */
#ifndef TVI_SRC_RUN_PARALLEL_FOR_H
#define TVI_SRC_RUN_PARALLEL_FOR_H

#include <stdbool.h>

/* Returns the number of threads that OpenMP uses if no number is given; 1 without OpenMP. */
int tvi_parallel_default_thread_count(void);
/* Tells whether this number of threads can be started, since OpenMP ends the program if it cannot start one. Numbers up
 * to that of the processors are accepted without a test. */
bool tvi_parallel_can_start_threads(int threads);
/* Calls body(ctx, thread, i) for each i < count, in any order, in several threads. Each thread has its own number
 * `thread` with 0 <= thread < threads, and makes one call at a time. */
typedef void tvi_parallel_body(void *ctx, int thread, int i);
void tvi_parallel_for(int threads, int count, tvi_parallel_body *body, void *ctx);

#endif
