/* parallel_for.c - Runs the iterations of a loop in several POSIX threads (parallel_for.h). */
#ifdef __linux__
#define _GNU_SOURCE /* for sched_getaffinity */
#endif
#include "run/parallel_for.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

/* One of the threads that a loop starts. */
typedef struct {
    tvi_parallel_team *team;
    pthread_t thread;
    int number;
} worker_thread;

struct tvi_parallel_team {
    int thread_count, started_count; /* the most threads, and those that a running loop has started */
    worker_thread *started;          /* [thread_count - 1] */
    tvi_parallel_body *body;
    void *ctx;
    int count;       /* the number of calls */
    atomic_int next; /* the first call that no thread has begun; at least `count` if the loop is to end */
    atomic_bool is_stopped;
};

int tvi_parallel_default_thread_count(void)
{
#ifdef __linux__
    cpu_set_t allowed;
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return CPU_COUNT(&allowed);
#endif
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    return processors > 0 ? (int)processors : 1;
}

tvi_parallel_team *tvi_parallel_team_create(int threads)
{
    tvi_parallel_team *team = calloc(1, sizeof *team);
    if (!team) return NULL;
    team->thread_count = threads;
    team->started = calloc((size_t)threads, sizeof *team->started);
    if (team->started) return team;
    free(team);
    return NULL;
}

/* A thread takes a part of the calls that are left, so that threads meet seldom, and end together. */
static void make_calls(tvi_parallel_team *team, int number)
{
    for (;;) {
        int first = atomic_load(&team->next), few;
        do {
            if (first >= team->count) return;
            few = 1 + (team->count - first) / (4 * team->thread_count);
        } while (!atomic_compare_exchange_weak(&team->next, &first, first + few));
        for (int i = first; i < first + few && !atomic_load(&team->is_stopped); i++) team->body(team->ctx, number, i);
    }
}

static void *run_thread(void *started)
{
    const worker_thread *own = started;
    make_calls(own->team, own->number);
    return NULL;
}

static void join_threads(tvi_parallel_team *team)
{
    for (; team->started_count > 0; team->started_count--)
        (void)pthread_join(team->started[team->started_count - 1].thread, NULL);
}

void tvi_parallel_stop(tvi_parallel_team *team) { atomic_store(&team->is_stopped, true); }

bool tvi_parallel_is_stopped(const tvi_parallel_team *team) { return atomic_load(&team->is_stopped); }

/* Ends a loop, also one that an exception leaves. */
static void end_loop(tvi_parallel_team **team)
{
    tvi_parallel_stop(*team);
    join_threads(*team);
}

void tvi_parallel_team_free(tvi_parallel_team *team)
{
    if (!team) return;
    end_loop(&team);
    free(team->started);
    free(team);
}

void tvi_parallel_for(tvi_parallel_team *team, int count, tvi_parallel_body *body, void *ctx)
{
    team->body = body;
    team->ctx = ctx;
    team->count = count;
    atomic_store(&team->next, 0);
    atomic_store(&team->is_stopped, false);
    __attribute__((cleanup(end_loop))) tvi_parallel_team *running = team;
    for (int number = 1; number < team->thread_count && number < count; number++) {
        worker_thread *thread = &team->started[team->started_count];
        *thread = (worker_thread){.team = team, .number = number};
        if (pthread_create(&thread->thread, NULL, run_thread, thread) != 0) break;
        team->started_count++;
    }
    make_calls(running, 0);
    join_threads(running);
}
