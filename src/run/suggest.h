/* suggest.h - what trial steps say of a run (suggest.c). */
#ifndef TVI_SRC_RUN_SUGGEST_H
#define TVI_SRC_RUN_SUGGEST_H

#include "tvi.h"

/* A suggestion, and what it was made from: the longest trial. */
typedef struct {
    double h;       /* suggested */
    double tried;   /* that of the trial, */
    double reached; /* the part of the duration that it covered, */
    double error;   /* and what it says of the error of a run with it */
    double seen;    /* the part of the duration that was looked at */
    long steps;     /* made in all, those of half the size included */
} tvi_suggestion;

/* tvi_suggest_step, with all that. */
TVI_NODISCARD tvi_status tvi_suggest(const tvi_system *system, const tvi_options *options, double t, const double q[],
                                     const double p[], double duration, double error, tvi_suggestion *out);

#endif
