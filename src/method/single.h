/* single.h - Makes the step of one member of a batch by the stepper's own step. Batch steppers call it for first steps
 * and for steps that fail in a lane, so that the treatment of failures is written once. */
#ifndef TVI_SRC_METHOD_SINGLE_H
#define TVI_SRC_METHOD_SINGLE_H

#include "method/stepper.h"

typedef struct tvi_single {
    const tvi_stepper *stepper;
    const tvi_system *system;
    void *work;
    /* Blocks of the single stepper, which have the parameters of the member. */
    const tvi_block *blocks;
    int width;
    double *parameters;
    double *q, *q_low, *p, *p_low; /* [n] of the member */
    tvi_increments increments;     /* of the member's step */
    double *block;                 /* [slots][points] */
} tvi_single;

/* Takes the work. `points` is the number of points of one member in a sweep; lane point * width + member belongs to the
 * member. */
void tvi_single_take(tvi_single *single, tvi_arena *arena, const tvi_stepper *stepper, const tvi_system *system,
                     const tvi_options *options, int width, int points);
void tvi_single_prepare(tvi_single *single);

/* Copy rows from [rows][width] to [rows], and back. */
void tvi_gather(int rows, int width, const double *from, int member, double to[]);
void tvi_scatter(int rows, int width, const double from[], int member, double *to);

/* Tells whether the tape has values for the member alone; x is the block of all members. */
bool tvi_single_is_inside(const tvi_single *single, const jet_tape *tape, const double *x, int points, int member);

/* Makes the step of the member, with its parameters in x. Returns false if the step fails. */
bool tvi_single_step(const tvi_single *single, const jet_tape *tape, const double *x, int points, double h,
                     const tvi_batch_origin *origin, const tvi_batch_end *end, int member, tvi_stats *stats);

#endif
