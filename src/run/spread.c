/* spread.c - the one file that knows of OpenMP. Without it one thread does all. */
#include "run/spread.h"

#ifdef _OPENMP
#include <omp.h>

int tvi_spread_threads(void) { return omp_get_max_threads(); }

void tvi_spread(int threads, int count, tvi_spread_work *work, void *ctx)
{
#pragma omp parallel for schedule(guided) num_threads(threads) if (threads > 1)
    for (int i = 0; i < count; i++) work(ctx, omp_get_thread_num(), i);
}

#else

int tvi_spread_threads(void) { return 1; }

void tvi_spread(int threads, int count, tvi_spread_work *work, void *ctx)
{
    (void)threads;
    for (int i = 0; i < count; i++) work(ctx, 0, i);
}

#endif
