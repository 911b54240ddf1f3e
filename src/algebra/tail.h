/* tail.h - Computes the tail of a step (tvi_stats.tail; docs/method.md, section 3), which shows whether its polynomials
 * have enough terms: the last term of the polynomial of the forces relative to the momentum, and that of the velocities
 * relative to the change of the coordinates. The tail is the largest of these ratios over all components. Each ratio
 * depends neither on the units nor on the origin of the coordinates. The curves call it. */
#ifndef TVI_SRC_TAIL_H
#define TVI_SRC_TAIL_H

#include "algebra/sizes.h"
#include "algebra/subsystems.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

/* [1] A component with less than this part of the largest share in its subsystem counts in proportion to its share
 * (tvi_component_tail). Its motion is then less than a hundredth of the largest one, as a share is a product of two
 * sizes. An example is the end of a chain that a wave has not reached: its first motion has the highest power of t,
 * however small h is. */
#define TAIL_MIN_SHARE 1e-4 /* found: make tails */
/* [1] The roundoff of a force, relative to the positions. */
#define TAIL_ROUNDOFF (32 * DBL_EPSILON) /* found: make tails */

/* The magnitudes of the quantities of one component in a step, from which its tail is computed. */
typedef struct {
    double momentum_size;         /* The magnitude of p plus that of its change in the step. */
    double q_change_size;         /* The movement: the magnitude of the change of q in the step. */
    double p_change_by_last_term; /* The part of the change of p that the last term of the series of p' makes. */
    /* The part of the change of q that the last term of the series of q' makes. It is 0 in a separable system, where q'
     * follows from p. */
    double q_change_by_last_term;
    double coordinate_size; /* The magnitude of q at the start, or at the centre of a Taylor curve. */
    /* 1 / momentum_size and 1 / q_change_size, of which sizes below TVI_LEAST_SIZE count as that size. */
    double one_over_momentum_size, one_over_q_change_size;
} tvi_component_sizes_in_step;

/* Returns the share of a component in the motion. The share is the squared movement if leaves_out_momentum, as for a
 * system with masses, so that a light body counts as much as a heavy one. Otherwise it is the momentum times the
 * movement. */
static inline double tvi_component_motion_share(const tvi_component_sizes_in_step *sizes, bool leaves_out_momentum)
{
    return (leaves_out_momentum ? sizes->q_change_size : sizes->momentum_size) * sizes->q_change_size;
}

/* Returns the larger one of two ratios, that of the last term of p to the momentum and that of the last term of q to
 * the movement, less the part that roundoff of the position causes. This part is the roundoff of the position relative
 * to the movement. 0 / 0 counts as 0. The function has no branches, since now one ratio and now the other is larger,
 * and processors could not predict which. */
static inline double tvi_component_last_term_ratio(const tvi_component_sizes_in_step *sizes)
{
    const double ratio_p = sizes->p_change_by_last_term * sizes->one_over_momentum_size;
    const double quotient_q = sizes->q_change_by_last_term * sizes->one_over_q_change_size;
    const double ratio_q = sizes->q_change_by_last_term > 0 ? quotient_q : 0,
                 ratio = ratio_p >= ratio_q ? ratio_p : ratio_q;
    const double roundoff = TAIL_ROUNDOFF * sizes->coordinate_size * sizes->one_over_q_change_size;
    const double rest = ratio - (sizes->coordinate_size > 0 ? roundoff : 0);
    return rest > 0 ? rest : 0;
}

/* Returns the tail of a component: its ratio (tvi_component_last_term_ratio), reduced if its share of the motion is
 * small. Below the limit of TAIL_MIN_SHARE times the largest share in its subsystem, the ratio is multiplied by the
 * share over the limit. */
static inline double tvi_component_tail(double last_term_ratio, double motion_share, double largest_motion_share)
{
    const double least = TAIL_MIN_SHARE * largest_motion_share,
                 quotient = motion_share * (1 / tvi_larger(least, DBL_MIN));
    return last_term_ratio * (motion_share < least ? quotient : 1);
}

/* Returns the tail of a step from motion_share and last_term_ratio [n] of its components. */
static inline double tvi_compute_tail(const tvi_subsystems *subsystems, int n, const double *motion_share,
                                      const double *last_term_ratio)
{
    double tail = 0;
    for (int subsystem = 0, k = 0; subsystem < subsystems->count; subsystem++) {
        const int first = k, end = tvi_subsystems_end(subsystems, subsystem, n);
        double largest_share = 0;
        for (; k < end; k++)
            largest_share = tvi_larger(motion_share[tvi_subsystems_component_at(subsystems, k)], largest_share);
        for (k = first; k < end; k++) {
            const int i = tvi_subsystems_component_at(subsystems, k);
            tail = tvi_larger(tvi_component_tail(last_term_ratio[i], motion_share[i], largest_share), tail);
        }
    }
    return tail;
}

#endif
