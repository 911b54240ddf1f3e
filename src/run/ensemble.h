/* ensemble.h - what an ensemble holds between runs. */
#ifndef TVI_SRC_RUN_ENSEMBLE_H
#define TVI_SRC_RUN_ENSEMBLE_H

#include "run/crowd.h"

#include <pthread.h>

/* What a thread has for itself: room for one block of members, and for one member. */
typedef struct {
    tvi_integrator *it;
    tvi_crowd *crowd; /* NULL: blocks have one member */
    double *q, *p;    /* [n] of the member at hand */
    double *D;        /* [rows][columns] */
} tvi_worker;

struct tvi_ensemble {
    const tvi_system *system;
    int n, members, threads;
    int lanes, blocks;    /* members of a block, the last one's are perhaps fewer, and how many there are */
    tvi_worker *worker;   /* [threads] */
    char *memory;         /* [blocks][remembered] the history of each block: an integrator's, or a crowd's */
    size_t remembered;    /* a multiple of the arena's alignment */
    double *parameters;   /* [tvi_system_parameters][members] */
    char *stops;          /* [members][tvi_stop_bytes] */
    tvi_status *failed;   /* [members] TVI_OK: it goes on */
    bool has_run;         /* since it was made or reset: the histories hold states */
    tvi_stats before;     /* counts of those who were loaded */
    int columns;          /* that the workers have room for */
    pthread_mutex_t told; /* held while an observer of a member is called */
};

/* The members of a block. */
static inline int tvi_first_member(const tvi_ensemble *e, int block) { return block * e->lanes; }
static inline int tvi_members_of(const tvi_ensemble *e, int block)
{
    const int rest = e->members - block * e->lanes;
    return rest < e->lanes ? rest : e->lanes;
}

/* A block's history to the worker, with its parameters, and back. */
void tvi_worker_load(tvi_worker *worker, const tvi_ensemble *ensemble, int block);
void tvi_worker_store(const tvi_worker *worker, tvi_ensemble *ensemble, int block);

/* Of a block that is loaded: the worker's integrator becomes that of the member in the lane, and gives back what it
 * is. */
void tvi_worker_enter(tvi_worker *worker, const tvi_ensemble *ensemble, int member);
void tvi_worker_leave(tvi_worker *worker, const tvi_ensemble *ensemble, int member);

#endif
