/* roundoff.h - Estimates the roundoff in the values of a field: the effect of a unit of roundoff in each input, and in
 * each operation on the way (docs/method.md section 5). Iterations whose corrections no longer shrink call it. */
#ifndef TVI_SRC_SYSTEM_ROUNDOFF_H
#define TVI_SRC_SYSTEM_ROUNDOFF_H

#include "system/system.h"

/* Corrections that no longer shrink are roundoff if they are at most this many units of it. Near equilibria one in a
 * hundred was larger, which costs a pass or a Jacobian matrix. Corrections that are no roundoff but below this limit
 * are as small. */
static const double TVI_ROUNDOFF_UNITS = 32;

typedef struct {
    double *change; /* [outputs of the field] the result */
    double *x;      /* block of the field's series at one point */
    /* Its tangents, one for each random choice of the signs of the rounding errors. */
    double *dx;
    /* State of a pseudo-random sequence. Each estimate restarts it, so that no step depends on others. */
    unsigned random;
} tvi_roundoff;

/* The number of samples of signs. In a single sample the parts of a sum may cancel. */
enum { TVI_ROUNDOFF_SAMPLES = 4 };

/* Computes dx [slots][TVI_ROUNDOFF_SAMPLES]: the effect on every slot of a unit of roundoff in each input and in each
 * operation. The roundoff of an input is relative to size[inputs], or to the input itself if size is NULL. x [slots]
 * holds the values, a block of a tape of series. The constants' dx are 0 beforehand. */
void tvi_roundoff_sweep(const jet_tape *tape, int inputs, const double size[], const double *x, double *dx);

void tvi_roundoff_take(tvi_roundoff *roundoff, tvi_arena *arena, const tvi_system *system);

/* Computes change[i], the largest change of output i of the field at one of the points if each coordinate, velocity and
 * momentum, and the result of each operation, changes by a unit of its own roundoff. The time is left out, since it is
 * the same in all passes of a step. A sum has the roundoff of its terms. inputs[i * lanes + point] are the inputs of
 * the field, then the time if it is used. If the field has no value at a point, the change is 0 there. Returns the
 * number of values of the field that were computed. */
int tvi_roundoff_of_field(tvi_roundoff *roundoff, const tvi_system *system, const double *inputs, int lanes,
                          int points);

/* The next sign of the sequence times size, after a call of tvi_roundoff_of_field. */
double tvi_roundoff_sign(tvi_roundoff *roundoff, double size);

/* Tells whether the motion is so small that roundoff has another size than the motion. q, rows [n][lanes], has to be no
 * farther from the start than the start is from the origin, and than the velocity leads; or the momentum no farther
 * than it is from 0. Passes that run off to where the field is only roundoff are not near. p is not used in a separable
 * system. */
bool tvi_roundoff_is_near(const tvi_system *system, double h, const double q_start[], const double p_start[],
                          const double *q, const double *p, int lanes, int points);

#endif
