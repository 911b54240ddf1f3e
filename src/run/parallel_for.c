/* parallel_for.c - Runs the iterations of a loop in several POSIX threads (parallel_for.h). */
#ifdef __linux__
#define _GNU_SOURCE /* for sched_getaffinity */
#endif
#include "run/parallel_for.h"

#include <sched.h>
#include <unistd.h>

int tvi_parallel_thread_count(void)
{
#ifdef __linux__
    cpu_set_t allowed;
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return CPU_COUNT(&allowed);
#endif
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    return processors > 0 ? (int)processors : 1;
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
    const tvi_parallel_thread *own = started;
    make_calls(own->team, own->number);
    return NULL;
}

static void join_threads(tvi_parallel_team *team)
{
    for (; team->started_count > 0; team->started_count--)
        (void)pthread_join(team->started[team->started_count - 1].thread, NULL);
}

void tvi_parallel_end(tvi_parallel_team *team)
{
    tvi_parallel_cancel(team);
    join_threads(team);
}

/* Ends a loop that an exception leaves. */
static void end_loop(tvi_parallel_team **team) { tvi_parallel_end(*team); }

void tvi_parallel_for(tvi_parallel_team *team, int count, tvi_parallel_body *body, void *ctx)
{
    team->body = body;
    team->ctx = ctx;
    team->count = count;
    atomic_store(&team->next, 0);
    atomic_store(&team->is_stopped, false);
    __attribute__((cleanup(end_loop))) tvi_parallel_team *running = team;
    for (int number = 1; number < team->thread_count && number < count; number++) {
        tvi_parallel_thread *thread = &team->started[team->started_count];
        *thread = (tvi_parallel_thread){.team = team, .number = number};
        if (pthread_create(&thread->thread, NULL, run_thread, thread) != 0) break;
        team->started_count++;
    }
    make_calls(running, 0);
    join_threads(running);
}
