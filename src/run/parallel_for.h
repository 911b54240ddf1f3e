/* parallel_for.h - Runs the iterations of a loop in several POSIX threads. Ensembles call it. */
#ifndef TVI_SRC_RUN_PARALLEL_FOR_H
#define TVI_SRC_RUN_PARALLEL_FOR_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

typedef void tvi_parallel_body(void *ctx, int thread, int i);
typedef struct tvi_parallel_team tvi_parallel_team;
/* A thread that a loop starts, and its number. */
typedef struct {
    tvi_parallel_team *team;
    pthread_t thread;
    int number;
} tvi_parallel_thread;

/* The threads of a loop. They are started by each loop and end with it, so that a process that forks has none to lose.
 * The team is in memory that outlives the function that runs the loop, since a callback may leave it by longjmp. */
struct tvi_parallel_team {
    int thread_count, started_count; /* the most threads, and those that a running loop has started */
    tvi_parallel_thread *started;    /* [thread_count] memory of the caller */
    tvi_parallel_body *body;
    void *ctx;
    int count;              /* the number of calls */
    atomic_int next;        /* the first call that no thread has begun */
    atomic_bool is_stopped; /* whether the loop was cancelled (tvi_parallel_cancel) */
};

/* Returns the number of processors that this process may use. */
int tvi_parallel_thread_count(void);

/* Calls body(ctx, thread, i) for each i < count, in any order, in several threads, of which the caller is number 0.
 * Each thread has its own number, and makes one call at a time. If threads cannot be started, the others make all
 * calls. An exception of C++ that leaves `body` in the caller's thread stops the other threads, and passes on. */
void tvi_parallel_for(tvi_parallel_team *team, int count, tvi_parallel_body *body, void *ctx);
/* Cancels a loop: its threads begin no further call of `body`. Does not wait for the calls that run. A long call of
 * `body` may ask tvi_parallel_is_stopped, and return early. */
static inline void tvi_parallel_cancel(tvi_parallel_team *team) { atomic_store(&team->is_stopped, true); }
static inline bool tvi_parallel_is_stopped(const tvi_parallel_team *team) { return atomic_load(&team->is_stopped); }
/* Cancels a loop that was left, and joins its threads. */
void tvi_parallel_end(tvi_parallel_team *team);

#endif
