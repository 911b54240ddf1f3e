/* tail.h - Computes the tail of a step (tvi_stats.tail; docs/method.md, section 3), which shows whether its polynomials
 * have enough terms: the last term of the polynomial of the forces relative to the momentum, and that of the velocities
 * relative to the change of the coordinates. The tail is the largest of these ratios over all components. Each ratio
 * depends neither on the units nor on the origin of the coordinates. The curves call it. */
#ifndef TVI_SRC_TAIL_H
#define TVI_SRC_TAIL_H

#include "algebra/sizes.h"
#include "algebra/subsystems.h"

#include <math.h>
#include <stdbool.h>

/* The magnitudes of the quantities of one component in a step, from which its tail is computed. */
typedef struct {
    double momentum_size;         /* The magnitude of p plus that of its change in the step. */
    double movement_size;         /* The movement: the magnitude of the change of q in the step. */
    double p_change_by_last_term; /* The part of the change of p that the last term of the series of p' makes. */
    /* The part of the change of q that the last term of the series of q' makes. It is 0 in a separable system, where q'
     * follows from p. */
    double q_change_by_last_term;
    double coordinate_size; /* The magnitude of q at the start, or at the centre of a Taylor curve. */
    double inverse_momentum_size, inverse_movement_size; /* 1 / momentum_size and 1 / movement_size. */
} tvi_tail_component;

/* Returns the share of a component in the motion. With masses, the share is the squared movement, so that a light body
 * counts as much as a heavy one. Without masses, it is the momentum times the movement. */
static inline double tvi_tail_component_motion_share(const tvi_tail_component *component, bool has_masses)
{
    return (has_masses ? component->movement_size : component->momentum_size) * component->movement_size;
}

/* Returns the larger one of two ratios, that of the last term of p to the momentum and that of the last term of q to
 * the movement, less the part that roundoff of the position causes. This part is the roundoff of the position relative
 * to the movement. 0 / 0 counts as 0. The function has no branches, since now one ratio and now the other is larger,
 * and processors could not predict which. */
static inline double tvi_tail_component_last_term_ratio(const tvi_tail_component *component)
{
    const double ratio_p = component->p_change_by_last_term * component->inverse_momentum_size;
    const double quotient_q = component->q_change_by_last_term * component->inverse_movement_size;
    const double ratio_q = component->q_change_by_last_term > 0 ? quotient_q : 0,
                 ratio = ratio_p >= ratio_q ? ratio_p : ratio_q;
    const double roundoff = TAIL_ROUNDOFF * component->coordinate_size * component->inverse_movement_size;
    const double rest = ratio - (component->coordinate_size > 0 ? roundoff : 0);
    return rest > 0 ? rest : 0;
}

/* Returns the ratio of a component (tvi_tail_component_last_term_ratio), reduced if the component has a small share of
 * the motion: below the limit of TAIL_MIN_SHARE times the largest share in its subsystem, the ratio is multiplied by
 * the share over the limit. */
static inline double tvi_tail_reduce_ratio_of_small_share(double ratio, double share, double largest_share)
{
    const double least = TAIL_MIN_SHARE * largest_share, quotient = share * (1 / least);
    return ratio * (share < least ? quotient : 1);
}

/* Computes tail [width], the tails of several members, from the shares and ratios [n][width] of their components. */
static inline void tvi_tail_compute_for_members(const tvi_subsystems *subsystems, int n, int width, const double *share,
                                                const double *ratio, double *tail)
{
    double largest_tail[BATCH_MAX_WIDTH];
    for (int m = 0; m < width; m++) largest_tail[m] = 0;
    for (int subsystem = 0, k = 0; subsystem < subsystems->count; subsystem++) {
        const int first = k, end = tvi_subsystems_end_in_component_list(subsystems, subsystem, n);
        double largest_share[BATCH_MAX_WIDTH];
        for (int m = 0; m < width; m++) largest_share[m] = 0;
        for (; k < end; k++)
            for (int m = 0; m < width; m++) {
                const double one = share[tvi_subsystems_component_at(subsystems, k) * width + m];
                largest_share[m] = tvi_larger(one, largest_share[m]);
            }
        for (k = first; k < end; k++)
            for (int m = 0; m < width; m++) {
                const int at = tvi_subsystems_component_at(subsystems, k) * width + m;
                const double one = tvi_tail_reduce_ratio_of_small_share(ratio[at], share[at], largest_share[m]);
                largest_tail[m] = tvi_larger(one, largest_tail[m]);
            }
    }
    for (int m = 0; m < width; m++) tail[m] = largest_tail[m];
}

#endif
