/* ensemble.h - what an ensemble holds between runs. */
#ifndef TVI_SRC_RUN_ENSEMBLE_H
#define TVI_SRC_RUN_ENSEMBLE_H

#include "run/integrator.h"

#include <pthread.h>

/* The memory of one thread, for one batch of members and for one member. */
typedef struct {
    tvi_integrator *batch; /* [width] */
    tvi_integrator *one;   /* the same where the width is 1 */
    double *q, *p;         /* [n] of the member at hand */
} tvi_worker;

struct tvi_ensemble {
    const tvi_system *system;
    int n, members, threads;
    int width, batches;   /* members of a batch, the last one's are perhaps fewer, and how many there are */
    tvi_worker *worker;   /* [threads] */
    char *memory;         /* [batches][remembered] the history of each batch */
    size_t remembered;    /* a multiple of the arena's alignment */
    double *parameters;   /* [tvi_system_parameters][members] */
    char *stops;          /* [members][tvi_stop_bytes] */
    tvi_status *failed;   /* [members] TVI_OK: it goes on */
    bool has_run;         /* since it was made or reset: the histories hold states */
    tvi_stats before;     /* counts of those who were loaded */
    pthread_mutex_t told; /* held while an observer of a member is called */
};

/* The members of a batch. */
static inline int tvi_first_member(const tvi_ensemble *e, int batch) { return batch * e->width; }
static inline int tvi_members_of(const tvi_ensemble *e, int batch)
{
    const int rest = e->members - batch * e->width;
    return rest < e->width ? rest : e->width;
}

/* A batch's history to the worker, with its parameters, and back. */
void tvi_worker_load(tvi_worker *worker, const tvi_ensemble *ensemble, int batch);
void tvi_worker_store(const tvi_worker *worker, tvi_ensemble *ensemble, int batch);

/* The worker's integrator of one member becomes this one of the batch that is loaded, and gives back what it is. */
void tvi_worker_enter(tvi_worker *worker, const tvi_ensemble *ensemble, int member);
void tvi_worker_leave(tvi_worker *worker, const tvi_ensemble *ensemble, int member);

#endif
