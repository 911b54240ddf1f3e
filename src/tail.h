/* tail.h - what tvi_stats.tail is made of: how much of what drives a component is in the last term of its polynomial
 * (docs/method.md section 3). A ratio of one component each, so that it depends neither on the units nor on where the
 * origin is; the largest counts. */
#ifndef TVI_SRC_TAIL_H
#define TVI_SRC_TAIL_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

/* Of one component, all over the step and without sign. */
typedef struct {
    double momentum; /* p and its change */
    double movement; /* of q */
    double last_p;   /* the last term of p', times what makes it a momentum */
    double last_q;   /* that of q', where it is not p' that makes it: of a Hamiltonian or a Lagrangian */
    double place;    /* q */
} tvi_tail_part;

/* A component that does less than a hundredth of what another one does is measured by the other one: as the end of a
 * chain that a wave has not reached, whose first motion is always of the highest power of t, however small h is. That
 * is the square of what components have in common: velocity, or momentum times velocity where there are no masses. */
#define TVI_TAIL_LEAST 1e-4

static inline double tvi_tail_share(const tvi_tail_part *part, bool has_masses)
{
    return (has_masses ? part->movement : part->momentum) * part->movement;
}

/* The roundoff of a force is that of the positions that it is made of, relative to how far they move. */
static inline double tvi_tail_of(const tvi_tail_part *part, bool has_masses, double largest)
{
    const double roundoff = 32 * DBL_EPSILON, share = tvi_tail_share(part, has_masses),
                 least = TVI_TAIL_LEAST * largest;
    const double p = part->last_p > 0 ? part->last_p / part->momentum : 0;
    const double q = part->last_q > 0 ? part->last_q / part->movement : 0;
    const double ratio = (p > q ? p : q) - (part->place > 0 ? roundoff * part->place / part->movement : 0);
    return ratio > 0 ? ratio * (share < least ? share / least : 1) : 0;
}

#endif
