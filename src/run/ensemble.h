/* ensemble.h - Declares the memory of an ensemble between its runs, and the functions by which a thread loads and
 * stores the members of a batch. ensemble.c, ensemble_run.c and travel.c include it. */
#ifndef TVI_SRC_RUN_ENSEMBLE_H
#define TVI_SRC_RUN_ENSEMBLE_H

#include "refusal.h"
#include "run/integrator.h"

#include <pthread.h>

/* The memory of one thread: an integrator that steps a batch of members together, and one that steps a single
 * member. */
typedef struct {
    tvi_integrator *batch_integrator;
    tvi_integrator *single_integrator; /* the same integrator as batch_integrator if batches have one member */
    double *member_q, *member_p;       /* [n] each, the state of the member that single_integrator steps */
} tvi_ensemble_worker;

struct tvi_ensemble {
    const tvi_system *system;
    /* The number of coordinates of a member; the number of members; the largest number of threads of a run. */
    int n, member_count, thread_count;
    /* The number of members in a batch, of which the last batch may have fewer; the number of batches. */
    int width, batch_count;
    tvi_ensemble_worker *workers; /* [thread_count] the memory of each thread */
    char *batch_histories;        /* [batch_count][history_bytes] each batch's history (integrator.h) between runs */
    size_t history_bytes;         /* the size of one history in bytes, a multiple of the arena's alignment */
    double *parameters;           /* [tvi_system_parameters][member_count] each member's parameter values */
    /* [member_count][tvi_size_of_stop_in_bytes] the tvi_event_stop of each member, the state at which events have
     * stopped its run */
    char *stops;
    tvi_status *failure_status; /* [member_count] TVI_OK if the member can go on, otherwise the status of its failure */
    bool has_run;               /* true if the ensemble has run since it was created or reset */
    bool is_running;            /* true during a run, in which observers may neither read nor change the members */
    tvi_stats loaded_stats;     /* the counts (tvi_stats) that were loaded with a saved state */
    pthread_mutex_t observer_lock; /* a thread holds this lock while it calls an observer of a member */
};

static inline tvi_event_stop *tvi_stop_of_member(const tvi_ensemble *ensemble, int member)
{
    return (tvi_event_stop *)(void *)(ensemble->stops + (size_t)member * tvi_size_of_stop_in_bytes(ensemble->n));
}

/* The index of the first member of a batch. */
static inline int tvi_first_member_of_batch(const tvi_ensemble *ensemble, int batch) { return batch * ensemble->width; }
/* The number of members of a batch. */
static inline int tvi_count_members_of_batch(const tvi_ensemble *ensemble, int batch)
{
    const int rest = ensemble->member_count - batch * ensemble->width;
    return rest < ensemble->width ? rest : ensemble->width;
}

/* Refuses a call from an observer of a running ensemble, whose threads are using the members. */
static inline tvi_status tvi_ensemble_refuse_if_running(const tvi_ensemble *ensemble)
{
    if (!ensemble->is_running) return TVI_OK;
    return jet_refuse(TVI_EINVAL, "the ensemble is in a run, whose observer may not run, read or change its members");
}

/* Copies the history and the parameters of a batch from the ensemble to the worker's batch integrator. */
void tvi_worker_load_batch(tvi_ensemble_worker *worker, const tvi_ensemble *ensemble, int batch);
/* Copies the history of the batch from the worker's batch integrator to the ensemble. */
void tvi_worker_store_batch(const tvi_ensemble_worker *worker, tvi_ensemble *ensemble, int batch);

/* Copies one member of the loaded batch to the worker's integrator for a single member. */
void tvi_worker_load_member(tvi_ensemble_worker *worker, const tvi_ensemble *ensemble, int member);
/* Copies the member from the integrator for a single member back to the loaded batch. */
void tvi_worker_store_member(tvi_ensemble_worker *worker, const tvi_ensemble *ensemble, int member);

#endif
