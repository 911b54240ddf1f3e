/* roundoff.h - Estimates the roundoff in the values of a field: the effect of a unit of roundoff in each input, and
 * in each operation that computes the values (docs/method.md, section 5). Iterations call it to learn whether
 * corrections that no longer shrink are roundoff. */
#ifndef TVI_SRC_SYSTEM_ROUNDOFF_H
#define TVI_SRC_SYSTEM_ROUNDOFF_H

#include "system/system.h"

/* The memory in which roundoff is estimated. */
typedef struct tvi_roundoff_estimator {
    int output_count;        /* the number of outputs of the field */
    double *output_roundoff; /* [output_count] The estimate of the change of each output by roundoff. */
    double *field_block;     /* The values of all slots of field_series at one point. */
    /* [slots][TVI_ROUNDOFF_SAMPLES] The changes of all slots by rounding errors, for each random choice of their
     * signs. */
    double *propagated_roundoff_of_slots;
    /* The state of a pseudo-random sequence. Each estimate restarts the sequence, so that no step depends on earlier
     * steps. */
    unsigned random_state;
} tvi_roundoff_estimator;

/* The number of random choices of signs. With a single one the contributions to a sum might cancel. */
enum { TVI_ROUNDOFF_SAMPLES = 4 };

/* Computes dx [slots][TVI_ROUNDOFF_SAMPLES], the effect on every slot of a unit of roundoff in each input and in each
 * operation. The roundoff of an input is relative to input_sizes [input_count], or to the input itself if input_sizes
 * is NULL. x is a block of a tape of series, in which the values of all slots are set. The caller has set dx of the
 * constants to 0. */
void tvi_roundoff_sweep_tape(const jet_tape *tape, int input_count, const double input_sizes[], const double *x,
                             double *dx);

/* Allocates the memory of the estimate in an arena. */
void tvi_roundoff_allocate(tvi_roundoff_estimator *roundoff, tvi_arena *arena, const tvi_system *system);

/* Computes output_roundoff[i]: the largest change of output i of the field at any of the points, if each coordinate,
 * velocity, momentum and result of an operation changes by a unit of its own roundoff. Roundoff of the time is left
 * out, since the time is the same in all passes of a step. The roundoff of a sum is that of its terms. inputs[i *
 * lanes + point] are the inputs of the field, followed by the time if it is used. The change is 0 at points where
 * the field has no value. Returns the number of evaluations of the field. */
int tvi_roundoff_estimate_field(tvi_roundoff_estimator *roundoff, const tvi_system *system, const double *inputs,
                                int lanes, int point_count);

/* Returns `size` or -`size` by the next number of the pseudo-random sequence, which tvi_roundoff_estimate_field
 * restarts. */
double tvi_roundoff_sign_randomly(tvi_roundoff_estimator *roundoff, double size);

/* Tells whether the nodes of a step of size h are near enough to its start for their roundoff to be that of the step.
 * This is the case if the coordinates q_at_nodes [n][lanes], of which node_count columns are used, stay closer to
 * q_start than |q_start| plus a multiple of |h v_start|, or if the momenta p_at_nodes stay closer to p_start than
 * |p_start|. For a system that is not separable, v_start counts as 0; for a separable system, the momenta are ignored.
 * By this test the callers exclude passes that have diverged to states at which the field is nothing but roundoff. */
bool tvi_roundoff_may_exceed_motion(const tvi_system *system, double h, const double q_start[], const double p_start[],
                                    const double *q_at_nodes, const double *p_at_nodes, int lanes, int node_count);

#endif
