/* tail.h - what tvi_stats.tail is made of: how much of what drives a component is in the last term of its polynomial
 * (docs/method.md section 3). A ratio of one component each, so that it depends neither on the units nor on where the
 * origin is; the largest counts. */
#ifndef TVI_SRC_TAIL_H
#define TVI_SRC_TAIL_H

#include "algebra/sizes.h"
#include "algebra/subsystems.h"

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
    double per_momentum, per_movement; /* 1 / momentum, 1 / movement */
} tvi_tail_part;

/* A component that does less than a hundredth of what another one does that it knows is measured by the other one: as
 * the end of a chain that a wave has not reached, whose first motion is always of the highest power of t, however small
 * h is. That is the square of what components have in common: velocity, so that a light body is not less than a heavy
 * one, or momentum times velocity where there are no masses. */
#define TVI_TAIL_LEAST 1e-4

/* All that one look at the components of a subsystem shows: the largest ratio, the share of the component
 * that has it, and the largest share. */
typedef struct {
    double ratio, share, largest;
} tvi_tail_survey;

static inline double tvi_tail_share(const tvi_tail_part *part, bool has_masses)
{
    return (has_masses ? part->movement : part->momentum) * part->movement;
}

/* Less the roundoff of a force, which is that of the positions that it is made of, relative to how far they move. What
 * is 0 / 0 counts as 0. No branches: which of two is the larger changes from step to step. */
static inline double tvi_tail_ratio(const tvi_tail_part *part)
{
    const double of_p = part->last_p * part->per_momentum, of_q = part->last_q * part->per_movement;
    const double known_q = part->last_q > 0 ? of_q : 0, ratio = of_p >= known_q ? of_p : known_q;
    const double of_place = 32 * DBL_EPSILON * part->place * part->per_movement;
    const double rest = ratio - (part->place > 0 ? of_place : 0);
    return rest > 0 ? rest : 0;
}

static inline void tvi_tail_look(tvi_tail_survey *survey, const tvi_tail_part *part, bool has_masses)
{
    const double share = tvi_tail_share(part, has_masses), ratio = tvi_tail_ratio(part);
    if (share > survey->largest) survey->largest = share;
    if (ratio <= survey->ratio) return;
    survey->ratio = ratio;
    survey->share = share;
}

/* Whether the largest ratio is the tail: a component that does little does not have it. */
static inline bool tvi_tail_is_known(const tvi_tail_survey *survey)
{
    return survey->share >= TVI_TAIL_LEAST * survey->largest;
}

static inline double tvi_tail_of(double ratio, double share, double largest)
{
    const double least = TVI_TAIL_LEAST * largest, part = share * (1 / least);
    return ratio * (share < least ? part : 1);
}

/* out[width] = the tails of several members, of share and ratio [n][width]. */
enum { TVI_TAIL_MOST_WIDTH = 64 };
static inline void tvi_tails_of_members(const tvi_subsystems *parts, int n, int width, const double *share,
                                        const double *ratio, double *out)
{
    double most[TVI_TAIL_MOST_WIDTH];
    for (int m = 0; m < width; m++) most[m] = 0;
    for (int part = 0, k = 0; part < parts->count; part++) {
        const int first = k, end = tvi_subsystems_end(parts, part, n);
        double largest[TVI_TAIL_MOST_WIDTH];
        for (int m = 0; m < width; m++) largest[m] = 0;
        for (; k < end; k++)
            for (int m = 0; m < width; m++) {
                const double one = share[tvi_subsystems_member(parts, k) * width + m];
                largest[m] = one > largest[m] ? one : largest[m];
            }
        for (k = first; k < end; k++)
            for (int m = 0; m < width; m++) {
                const int at = tvi_subsystems_member(parts, k) * width + m;
                const double tail = tvi_tail_of(ratio[at], share[at], largest[m]);
                most[m] = tail > most[m] ? tail : most[m];
            }
    }
    for (int m = 0; m < width; m++) out[m] = most[m];
}

#endif
