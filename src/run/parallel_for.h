/* parallel_for.h - Runs the iterations of a loop in several POSIX threads. Ensembles call it. */
#ifndef TVI_SRC_RUN_PARALLEL_FOR_H
#define TVI_SRC_RUN_PARALLEL_FOR_H

#include <stdbool.h>

/* The threads of a loop. It is in memory that outlives the function that runs the loop, since a callback may leave that
 * function by longjmp. */
typedef struct tvi_parallel_team tvi_parallel_team;

/* Returns the number of processors that this process may use. */
int tvi_parallel_default_thread_count(void);

/* Creates a team of this number of threads at most, which are started by each loop and end with it; so a process that
 * forks has no threads to lose. Returns NULL if memory is lacking. */
tvi_parallel_team *tvi_parallel_team_create(int threads);
/* Waits for the threads of a loop that was left by longjmp, and frees the team. NULL is allowed. */
void tvi_parallel_team_free(tvi_parallel_team *team);

/* Calls body(ctx, thread, i) for each i < count, in any order, in several threads, of which the caller is number 0.
 * Each thread has its own number, and makes one call at a time. If threads cannot be started, the others make all
 * calls. An exception of C++ that leaves `body` in the caller's thread stops the other threads, and passes on. */
typedef void tvi_parallel_body(void *ctx, int thread, int i);
void tvi_parallel_for(tvi_parallel_team *team, int count, tvi_parallel_body *body, void *ctx);
/* Lets the threads of a loop begin no further call. */
void tvi_parallel_stop(tvi_parallel_team *team);
/* Tells whether a loop was stopped; a long call of `body` may then return early. */
bool tvi_parallel_is_stopped(const tvi_parallel_team *team);

#endif
