/* system.h - what the steppers need of the user's problem. */
#ifndef TVI_SRC_SYSTEM_H
#define TVI_SRC_SYSTEM_H

#include "tape.h"
#include "tvi.h"

struct tvi_system {
    int n;
    bool uses_time;         /* the tapes of the force then have the time as input n */
    double *mass;           /* [n] */
    jet_graph *graph;       /* closed; kept so that jets that outlive it are recognised */
    jet_tape *force_series; /* inputs q (and t), outputs F[n] */
    jet_tape *force_values;
    jet_tape *potential;    /* inputs q (and t), output V; NULL for a force */
};

#endif
