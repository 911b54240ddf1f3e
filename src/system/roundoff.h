/* roundoff.h - how well the values of a field are known: what a unit of roundoff in each of its inputs makes of them
 * (docs/method.md section 5). An iteration asks where its corrections shrink no more. */
#ifndef TVI_SRC_SYSTEM_ROUNDOFF_H
#define TVI_SRC_SYSTEM_ROUNDOFF_H

#include "algebra/arena.h"
#include "system/system.h"

/* Corrections that no longer shrink are roundoff up to this many units of it: near equilibria one in a hundred of those
 * that were was larger, which costs a pass or a Jacobian; and what is none, and ends there, is as small. */
static const double TVI_ROUNDOFF_UNITS = 32;

typedef struct {
    double *change;  /* [outputs of the field] the result */
    double *inputs;  /* [inputs][lanes] as they were */
    double *outputs; /* [outputs][lanes] where the inputs have moved */
    unsigned random; /* state of a pseudo-random sequence, the same for each question: no step depends on others */
} tvi_roundoff;

/* lanes: of the blocks that are asked about. */
void tvi_roundoff_take(tvi_roundoff *roundoff, tvi_arena *arena, const tvi_system *system, int lanes);

/* change[i] = the most that output i of the field changes in a lane when each coordinate, velocity and momentum moves
 * by a unit of its own roundoff, one way or the other; not the time, which is the same in all passes of a step. The
 * tape is one of the field's. The block keeps its inputs, and has been run for them; returns how many values of the
 * field in each lane that cost. Where the field has no value so near, nothing is known, and the change is 0. */
int tvi_roundoff_of_field(tvi_roundoff *roundoff, const tvi_system *system, const jet_tape *tape, double *x, int lanes);

/* The next sign of the sequence, times size; after tvi_roundoff_of_field. */
double tvi_roundoff_sign(tvi_roundoff *roundoff, double size);

#endif
