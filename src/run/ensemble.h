/* ensemble.h - Declares the memory of an ensemble between its runs, and the functions by which a thread loads and
 * stores a member. ensemble.c and ensemble_run.c include it. */
#ifndef TVI_SRC_RUN_ENSEMBLE_H
#define TVI_SRC_RUN_ENSEMBLE_H

#include "refusal.h"
#include "run/run.h"

#include <pthread.h>

/* The memory of one thread: the integrator that runs its members one after the other, and the state of the member that
 * it runs. */
typedef struct {
    tvi_integrator *integrator;
    double *member_q, *member_p; /* [n] each */
} tvi_ensemble_worker;

/* All that an integrator holds between its runs is its history, with a copy of it from before the last step, its
 * parameters, its last stop, and the following numbers. */
typedef struct {
    tvi_stats stats; /* the counts of this member; `bytes` is 0 */
    /* The integrator's fields of the same names, which describe the last step. */
    double h, covered_time;
    long has_dense_output;
} tvi_member_record;

/* A segment of an ensemble's run: the steps of all members between two calls of the ensemble's own observer, or all
 * steps if there is no observer. */
typedef struct {
    tvi_run_plan plan;              /* the plan of the run, with the number of steps of this segment */
    long step_count_before_segment; /* the number of steps in earlier segments of the run */
    double *t, *q, *p;              /* the user's arrays of all members' states */
    tvi_status *member_status;      /* [member_count] the user's array of the members' statuses */
} tvi_ensemble_segment;

struct tvi_ensemble {
    const tvi_system *system;
    /* The number of coordinates of a member; the number of members; the largest number of threads of a run. */
    int n, member_count, thread_count;
    tvi_ensemble_worker *workers; /* [thread_count] the memory of each thread */
    /* [member_count][history_bytes] Each member's history between runs, followed by the copied part of it as it was
     * before the member's last step, as in the memory of an integrator. */
    char *histories;
    size_t history_bytes;       /* the size of both parts in bytes, a multiple of the arena's alignment */
    tvi_member_record *records; /* [member_count] */
    double *parameters;         /* [tvi_system_parameters][member_count] each member's parameter values */
    tvi_step_columns *columns;  /* [member_count] the tangent vectors of each member's last step */
    /* [member_count][tvi_stop_bytes] the tvi_event_stop of each member, the state at which events have stopped its
     * run */
    char *stops;
    tvi_status *failure_status; /* [member_count] TVI_OK if the member can go on, otherwise the status of its failure */
    bool has_run;    /* true if the ensemble has run, or a member was loaded, since it was created or reset */
    bool is_running; /* true during a run, in which observers may neither read nor change the members */
    /* The threads of a run, and its present segment, which outlives a run that longjmp leaves. */
    tvi_parallel_team team;
    tvi_ensemble_segment segment;
    pthread_mutex_t observer_lock; /* a thread holds this lock while it calls an observer of a member */
};

static inline tvi_event_stop *tvi_stop_of_member(const tvi_ensemble *ensemble, int member)
{
    return (tvi_event_stop *)(void *)(ensemble->stops + (size_t)member * tvi_stop_bytes(ensemble->n));
}

/* Refuses a call from an observer of a running ensemble, whose threads are using the members. */
static inline tvi_status tvi_ensemble_refuse_if_running(const tvi_ensemble *ensemble)
{
    if (!ensemble->is_running) return TVI_OK;
    return jet_refuse(TVI_EINVAL, "the ensemble is in a run, whose observer may not run, read or change its members "
                                  "(if longjmp has left the run, free the ensemble)");
}

/* Copy the numbers of one member from an array [rows][members] to an array [rows], and back. */
static inline void tvi_gather_member(int rows, int members, const double *from, int member, double to[])
{
    for (int i = 0; i < rows; i++) to[i] = from[(size_t)i * (size_t)members + (size_t)member];
}
static inline void tvi_scatter_member(int rows, int members, const double from[], int member, double *to)
{
    for (int i = 0; i < rows; i++) to[(size_t)i * (size_t)members + (size_t)member] = from[i];
}

/* Load all that the member holds between runs into the worker's integrator, and store it. */
void tvi_worker_load_member(tvi_ensemble_worker *worker, tvi_ensemble *ensemble, int member);
void tvi_worker_store_member(tvi_ensemble_worker *worker, tvi_ensemble *ensemble, int member);

#endif
