/* single.h - Makes the step of one member of a batch, which is a group of members of an ensemble that are stepped
 * together. The step is made by the stepper for single integrators. Batch steppers call tvi_step_member for the first
 * step of a member, and for a step that fails in the batch, so that failures are treated by one stepper only. */
#ifndef TVI_SRC_METHOD_SINGLE_H
#define TVI_SRC_METHOD_SINGLE_H

#include "method/stepper.h"

/* The memory in which the step of one member is made. */
typedef struct tvi_member_stepper {
    const tvi_stepper *stepper;
    const tvi_system *system;
    void *stepper_work; /* The memory in which `stepper` makes the step of one member. */
    /* The first block in the list of the stepper's blocks (algebra/block.h). The parameters of the member are set in
     * all blocks of the list. */
    const tvi_tape_block *tape_block_list_of_stepper;
    int batch_width;           /* Number of members of the batch. */
    double *parameters;        /* The values of the member's parameters. */
    tvi_run_state start_state; /* The state of the member at the start of its step. */
    tvi_increments increments; /* The increments of the member's step. */
    double *member_block;      /* [slots][point_count] The member's lanes of a block of the batch. */
} tvi_member_stepper;

/* Allocates the vectors of a state and of the increments of a step, with n components each. */
void tvi_allocate_state_and_increments(tvi_arena *arena, int n, tvi_run_state *state, tvi_increments *increments);

/* Allocates the memory of a member stepper. `point_count` is the number of points of one member in a sweep. In a block
 * of the batch, lane point * width + member belongs to the member. */
void tvi_member_stepper_allocate(tvi_member_stepper *member_stepper, tvi_arena *arena, const tvi_stepper *stepper,
                                 const tvi_system *system, const tvi_options *options, int width, int point_count);
/* Sets the constants of the blocks and the tables of the stepper. It is called after the arena's memory is
 * allocated. */
void tvi_member_stepper_set_tables(tvi_member_stepper *member_stepper);

/* Copy the numbers of one member from an array [rows][width] to an array [rows], and back. */
void tvi_gather_member(int rows, int width, const double *from, int member, double to[]);
void tvi_scatter_member(int rows, int width, const double from[], int member, double *to);

/* Tells whether all operations of the tape are inside their domains for this member of a block of the batch. */
bool tvi_is_member_inside_domain(const tvi_member_stepper *member_stepper, const jet_tape *tape,
                                 const double *batch_block, int point_count, int member);

/* Makes the step of the member, with its parameters from a block of the batch. Returns false if the step fails; the
 * reason is then in results->status[member]. */
bool tvi_step_member(const tvi_member_stepper *member_stepper, const jet_tape *tape, const double *batch_block,
                     int point_count, double h, const tvi_batch_origin *origin, const tvi_batch_results *results,
                     int member, tvi_stats *stats);

#endif
