/* single.h - Makes the step of one member of a batch by the stepper for single integrators. Batch steppers call it
 * for first steps, and for steps that fail in a lane. Failures are thus treated in one place. */
#ifndef TVI_SRC_METHOD_SINGLE_H
#define TVI_SRC_METHOD_SINGLE_H

#include "method/stepper.h"

typedef struct tvi_member_stepper {
    const tvi_stepper *stepper;
    const tvi_system *system;
    void *work;
    /* Blocks of the stepper, which get the parameters of the member. */
    const tvi_block *blocks;
    int width; /* Number of members of the batch. */
    double *parameters;
    double *q, *q_low, *p, *p_low; /* [n] The member's state. */
    tvi_increments increments;     /* Increments of the member's step. */
    double *member_block;          /* [slots][points] A block of one member. */
} tvi_member_stepper;

/* Allocates the memory. `points` is the number of points of one member in a sweep. In the batch's block, lane point
 * * width + member belongs to the member. */
void tvi_member_stepper_allocate(tvi_member_stepper *member_stepper, tvi_arena *arena, const tvi_stepper *stepper,
                                 const tvi_system *system, const tvi_options *options, int width, int points);
void tvi_member_stepper_prepare(tvi_member_stepper *member_stepper);

/* Copy a member's column from an array [rows][width] to an array [rows], and back. */
void tvi_gather_member(int rows, int width, const double *from, int member, double to[]);
void tvi_scatter_member(int rows, int width, const double from[], int member, double *to);

/* Tells whether all operations of the tape are inside their domains for this member. x is the block of all members. */
bool tvi_is_member_inside_domain(const tvi_member_stepper *member_stepper, const jet_tape *tape, const double *x,
                                 int points, int member);

/* Makes the step of the member, with its parameters from the block x. Returns false if the step fails; end->status
 * has the reason. */
bool tvi_step_member(const tvi_member_stepper *member_stepper, const jet_tape *tape, const double *x, int points,
                     double h, const tvi_batch_origin *origin, const tvi_batch_results *results, int member,
                     tvi_stats *stats);

#endif
