/* single.h - the step of one of several members by the stepper's own step: what goes on in a lane of its own in no
 * other way, as first steps and those that fail, so that whatever may happen in a step is written once. */
#ifndef TVI_SRC_METHOD_SINGLE_H
#define TVI_SRC_METHOD_SINGLE_H

#include "method/stepper.h"

typedef struct {
    const tvi_stepper *stepper;
    const tvi_system *system;
    void *work;
    const tvi_block *blocks; /* its own: they have the parameters of the member whose step it makes */
    int width;
    double *parameters;
    double *q, *q_low, *p, *p_low; /* [n] of the member, */
    tvi_increments by;             /* and of its step */
    double *inside;                /* [slots][points] */
} tvi_single;

/* points: of one member in a sweep of all, each with a lane for each member: point * width + member. */
void tvi_single_take(tvi_single *single, tvi_arena *arena, const tvi_stepper *stepper, const tvi_system *system,
                     const tvi_options *options, int width, int points);
void tvi_single_prepare(tvi_single *single);

/* [rows][width] and [rows]. */
void tvi_gather(int rows, int width, const double *from, int member, double to[]);
void tvi_scatter(int rows, int width, const double from[], int member, double *to);

/* Whether the tape has values for the member alone; x: the block of all. */
bool tvi_single_is_inside(const tvi_single *single, const jet_tape *tape, const double *x, int points, int member);

/* Makes the step of the member, with the parameters that x has of it; false where it fails. */
bool tvi_single_step(const tvi_single *single, const jet_tape *tape, const double *x, int points, double h,
                     const tvi_batch_origin *origin, const tvi_batch_end *end, int member, tvi_stats *stats);

#endif
