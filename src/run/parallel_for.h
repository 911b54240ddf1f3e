/* parallel_for.h - Runs the iterations of a loop in several threads, for ensembles. */
#ifndef TVI_SRC_RUN_PARALLEL_FOR_H
#define TVI_SRC_RUN_PARALLEL_FOR_H

#include <stdbool.h>

/* The number of threads that OpenMP would use; 1 without OpenMP. */
int tvi_parallel_threads(void);
/* Tells whether this number of threads can be started. OpenMP ends the program if one cannot. It tries numbers above
 * that of the cores. */
bool tvi_parallel_can_start(int threads);
/* Calls body(ctx, thread, i) for each i < count, in any order. 0 <= thread < threads, and a thread makes one call at a
 * time. */
typedef void tvi_parallel_body(void *ctx, int thread, int i);
void tvi_parallel_for(int threads, int count, tvi_parallel_body *work, void *ctx);

#endif
