/* stepping.h - Declares steps of a system as a turn of turns.h. */
#ifndef STEPPING_H
#define STEPPING_H

#include "bodies.h"
#include "turns.h"

typedef struct {
    tvi_integrator *integrator;
    int n;
    const double *q, *p; /* the start */
    double h;
    long steps;    /* of a turn, from the start: 5 */
    double passes; /* of a step, in the last turn */
} stepping;

/* A failure ends the program. q and p must live as long. */
stepping stepping_open(const tvi_system *system, const tvi_options *options, const double q[], const double p[],
                       double h);
void stepping_close(stepping *s);
void stepping_go(void *ctx); /* a stepping */
/* us of a step. */
double stepping_time(const turn *t);

#endif
