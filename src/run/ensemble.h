/* ensemble.h - Declares what an ensemble holds between runs, and how a thread loads and stores its members. */
#ifndef TVI_SRC_RUN_ENSEMBLE_H
#define TVI_SRC_RUN_ENSEMBLE_H

#include "refusal.h"
#include "run/integrator.h"

#include <pthread.h>

/* The memory of one thread: an integrator for a batch of members, and one for a single member. */
typedef struct {
    tvi_integrator *batch;  /* [width] members */
    tvi_integrator *single; /* one member; the same integrator as `batch` if the width is 1 */
    double *q, *p;          /* [n] state of the single member */
} tvi_worker;

struct tvi_ensemble {
    const tvi_system *system;
    int n, members, threads;
    /* Members of a batch, and the number of batches; the last batch may have fewer members. */
    int width, batches;
    tvi_worker *worker;            /* [threads] */
    char *memory;                  /* [batches][history_bytes] the history of each batch */
    size_t history_bytes;          /* bytes of one history, a multiple of the arena's alignment */
    double *parameters;            /* [tvi_system_parameters][members] */
    char *stops;                   /* [members][tvi_stop_bytes] */
    tvi_status *failed;            /* [members] TVI_OK: the member can go on */
    bool has_run;                  /* since it was created or reset: the histories hold states */
    bool is_running;               /* the workers have the members: observers may neither read nor change these */
    tvi_stats loaded;              /* counts that were loaded with a saved state */
    pthread_mutex_t observer_lock; /* held while an observer of a member is called */
};

/* The first member of a batch, and how many members it has. */
static inline int tvi_first_member(const tvi_ensemble *e, int batch) { return batch * e->width; }
static inline int tvi_members_of(const tvi_ensemble *e, int batch)
{
    const int rest = e->members - batch * e->width;
    return rest < e->width ? rest : e->width;
}

/* Refuses a call from an observer of a member, during which the workers hold the members. */
static inline tvi_status tvi_ensemble_check_idle(const tvi_ensemble *e)
{
    if (!e->is_running) return TVI_OK;
    return jet_refuse(TVI_EINVAL, "the ensemble is in a run, whose observer may not run, read or change its members");
}

/* Copy the history and the parameters of a batch to the worker, and its history back to the ensemble. */
void tvi_worker_load(tvi_worker *worker, const tvi_ensemble *ensemble, int batch);
void tvi_worker_store(const tvi_worker *worker, tvi_ensemble *ensemble, int batch);

/* Copy a member of the loaded batch to the worker's integrator for one member, and back. */
void tvi_worker_load_member(tvi_worker *worker, const tvi_ensemble *ensemble, int member);
void tvi_worker_store_member(tvi_worker *worker, const tvi_ensemble *ensemble, int member);

#endif
