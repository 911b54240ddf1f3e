/* roundoff.h - how well the values of a field are known: what a unit of roundoff in each of its inputs, and in each
 * operation on the way, makes of them (docs/method.md section 5). An iteration asks where its corrections shrink no
 * more. */
#ifndef TVI_SRC_SYSTEM_ROUNDOFF_H
#define TVI_SRC_SYSTEM_ROUNDOFF_H

#include "system/system.h"

/* Corrections that no longer shrink are roundoff up to this many units of it: near equilibria one in a hundred of those
 * that were was larger, which costs a pass or a Jacobian; and what is none, and ends there, is as small. */
static const double TVI_ROUNDOFF_UNITS = 32;

typedef struct {
    double *change;  /* [outputs of the field] the result */
    double *x;       /* block of the field's series at one point */
    double *dx;      /* its tangents, one for each sample of signs */
    unsigned random; /* state of a pseudo-random sequence, the same for each question: no step depends on others */
} tvi_roundoff;

/* Of signs: in one sample alone the parts of a sum may cancel. */
enum { TVI_ROUNDOFF_SAMPLES = 4 };

/* dx [slots][TVI_ROUNDOFF_SAMPLES]: what a unit of roundoff in each input, relative to size[inputs] or, NULL, to the
 * input itself, and in each operation makes of every slot; x [slots]: their values, a block of a tape of series. The
 * constants' dx are 0 beforehand. */
void tvi_roundoff_sweep(const jet_tape *tape, int inputs, const double size[], const double *x, double *dx);

void tvi_roundoff_take(tvi_roundoff *roundoff, tvi_arena *arena, const tvi_system *system);

/* change[i] = the most that output i of the field changes at one of the points when each coordinate, velocity and
 * momentum, and the result of each operation, moves by a unit of its own roundoff, one way or the other; not the time,
 * which is the same in all passes of a step. A sum has the roundoff of its terms. inputs[i * lanes + point]: those of
 * the field, then the time if it is used. Returns how many values of the field that cost. Where the field has no value,
 * nothing is known, and the change is 0. */
int tvi_roundoff_of_field(tvi_roundoff *roundoff, const tvi_system *system, const double *inputs, int lanes,
                          int points);

/* The next sign of the sequence, times size; after tvi_roundoff_of_field. */
double tvi_roundoff_sign(tvi_roundoff *roundoff, double size);

/* Whether q, rows [n][lanes], is no farther from the start at all points than this is from the origin and the velocity
 * leads to; or the momentum than it is from 0. In a motion larger than that, roundoff has no other size than the
 * motion; and passes that run off, to where the field is nothing but roundoff, have not arrived. Of a separable
 * system p is not looked at. */
bool tvi_roundoff_is_near(const tvi_system *system, double h, const double q_start[], const double p_start[],
                          const double *q, const double *p, int lanes, int points);

#endif
