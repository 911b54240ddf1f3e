/* crowd.h - a block of members that are stepped at once, each in a lane of its own. */
#ifndef TVI_SRC_RUN_CROWD_H
#define TVI_SRC_RUN_CROWD_H

#include "run/crowd_loops.h"
#include "run/integrator.h"

/* All arrays [components][width]. What is in the history is the block's, and stays between runs. */
typedef struct {
    const tvi_crowd_stepper *stepper;
    const tvi_crowd_loops *loops;
    void *work;
    tvi_integrator *one;       /* of the same system and options: what is done for one member alone */
    int width, dimension;      /* of the system that steps are made of, */
    const tvi_system *stepped; /* with generated code where there is any */
    const tvi_block *blocks;   /* of tapes */
    char *history;
    size_t remembered;
    tvi_run_state now;       /* in the history */
    double *begun;           /* [2 n + 1][width] in the history: q, t and p where the runs began */
    tvi_kept_energy *kept;   /* [width] in the history */
    long *continues;         /* [width] in the history: the lane has what its member's last step returned */
    tvi_crowd_end end;       /* of a step */
    tvi_status *was;         /* [width] statuses before it */
    double *overflows;       /* [width] */
    double *change;          /* [width] the most that the stepper's step changes the energy by */
    bool *doubts;            /* [width] the energy is to be looked at */
    double *before, *after;  /* [width] energies; */
    double *q, *p;           /* where the step ends */
    tvi_energy_lanes energy; /* its block is NULL where they are computed one after the other */
    double *parameters;      /* [parameters][width] */
    tvi_stats stats;
} tvi_crowd;

/* NULL in *out where the method steps members one after the other; TVI_ENOMEM. It lives as long as `one`. */
TVI_NODISCARD tvi_status tvi_crowd_create(tvi_crowd **out, tvi_integrator *one);
void tvi_crowd_free(tvi_crowd *crowd); /* NULL is allowed */

/* Makes the values in `parameters` those that steps are made with. */
void tvi_crowd_apply_parameters(tvi_crowd *crowd);
/* The member's history from its lane, and back to it: what steps have left in the stepper's is forgotten. */
void tvi_crowd_get(const tvi_crowd *crowd, int lane, tvi_integrator *it);
void tvi_crowd_put(tvi_crowd *crowd, int lane, const tvi_integrator *it);
/* Makes a state that of the lane, as tvi_integrator_begin. */
TVI_NODISCARD tvi_status tvi_crowd_begin(tvi_crowd *crowd, int lane, double t, const double q[], const double p[]);

/* A lane that has no member repeats the first one's state. */
void tvi_crowd_repeat(tvi_crowd *crowd, int lane);
/* Whether its state is bitwise this one, also after a step that failed. */
bool tvi_crowd_has(const tvi_crowd *crowd, int lane, double t, const double q[], const double p[]);

/* So many steps of the lanes that are TVI_OK, until they are not. */
void tvi_crowd_steps(tvi_crowd *crowd, double h, long steps);

#endif
