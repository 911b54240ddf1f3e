/* suggest.h - Suggests a step size for a wanted error at the end of a run (suggest.c). tvi_suggest_step and the bench
 * call it. */
#ifndef TVI_SRC_RUN_SUGGEST_H
#define TVI_SRC_RUN_SUGGEST_H

#include "tvi.h"

/* A suggestion, and the longest trial that it rests on. */
typedef struct {
    double h;       /* the suggested step */
    double tried;   /* the step of that trial */
    double reached; /* the part of the duration that it covered */
    double error;   /* the estimated error of a run with this step */
    double seen;    /* the part of the duration that was explored */
    long steps;     /* made in all, those of half the size included */
} tvi_suggestion;

/* Does what tvi_suggest_step does, and returns all of the suggestion. */
TVI_NODISCARD tvi_status tvi_suggest(const tvi_system *system, const tvi_options *options, double t, const double q[],
                                     const double p[], double duration, double error, tvi_suggestion *out);

#endif
