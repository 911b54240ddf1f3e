/* spread.h - work spread over threads. */
#ifndef TVI_SRC_RUN_SPREAD_H
#define TVI_SRC_RUN_SPREAD_H

#include <stdbool.h>

/* As many threads as OpenMP would take; 1 without OpenMP. */
int tvi_spread_threads(void);
/* Whether so many can be started: OpenMP ends the program where one cannot. More than there are cores are tried. */
bool tvi_spread_can_start(int threads);
/* work(ctx, thread, i) for each i < count, in any order; 0 <= thread < threads, and each thread does one at a time. */
typedef void tvi_spread_work(void *ctx, int thread, int i);
void tvi_spread(int threads, int count, tvi_spread_work *work, void *ctx);

#endif
