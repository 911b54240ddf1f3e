/* parallel_for.c - Runs the iterations of a loop in several threads by OpenMP, or in one thread without OpenMP
 * (parallel_for.h). No other file uses OpenMP. */
#include "run/parallel_for.h"

#ifdef _OPENMP
#include <omp.h>
#include <pthread.h>
#include <stdlib.h>

int tvi_parallel_default_thread_count(void) { return omp_get_max_threads(); }

static void *lock_and_unlock_mutex(void *mutex)
{
    (void)pthread_mutex_lock(mutex);
    (void)pthread_mutex_unlock(mutex);
    return NULL;
}

bool tvi_parallel_can_start_threads(int threads)
{
    pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
    const int others = threads - 1;
    int started = 0;
    if (threads <= omp_get_num_procs()) return true;
    pthread_t *all = malloc((size_t)others * sizeof *all);
    if (!all) return false;
    (void)pthread_mutex_lock(&mutex);
    while (started < others && pthread_create(&all[started], NULL, lock_and_unlock_mutex, &mutex) == 0) started++;
    (void)pthread_mutex_unlock(&mutex);
    for (int i = 0; i < started; i++) (void)pthread_join(all[i], NULL);
    free(all);
    return started == others;
}

void tvi_parallel_for(int threads, int count, tvi_parallel_body *body, void *ctx)
{
#pragma omp parallel for schedule(guided) num_threads(threads) if (threads > 1)
    for (int i = 0; i < count; i++) body(ctx, omp_get_thread_num(), i);
}

#else

int tvi_parallel_default_thread_count(void) { return 1; }

bool tvi_parallel_can_start_threads(int threads) { return threads > 0; }

void tvi_parallel_for(int threads, int count, tvi_parallel_body *body, void *ctx)
{
    (void)threads;
    for (int i = 0; i < count; i++) body(ctx, 0, i);
}

#endif
