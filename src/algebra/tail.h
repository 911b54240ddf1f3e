/* tail.h - Computes tvi_stats.tail: the share of the last term in the polynomial of the forces (docs/method.md section
 * 3). It is a ratio for each component, so that it depends neither on units nor on the origin; the largest one
 * counts. */
#ifndef TVI_SRC_TAIL_H
#define TVI_SRC_TAIL_H

#include "algebra/sizes.h"
#include "algebra/subsystems.h"
#include "algebra/width.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

/* The sizes of one component over the step, without signs. */
typedef struct {
    double momentum; /* p and its change */
    double movement; /* of q */
    double last_p;   /* the last term of p', times the factor that makes it a momentum */
    /* The last term of q', for a Hamiltonian or a Lagrangian, where q' does not follow from p. */
    double last_q;
    double position;                   /* q */
    double per_momentum, per_movement; /* 1 / momentum, 1 / movement */
} tvi_tail_part;

/* A component whose share is less than this part of the largest share in its subsystem counts in proportion to its
 * share. An example is the end of a chain that a wave has not reached: its first motion has the highest power of t,
 * however small h is. The limit corresponds to a hundredth of the motion, as a share is a product of two of these:
 * squared velocity, so that a light body counts as much as a heavy one, or momentum times velocity if there are no
 * masses. */
#define TVI_TAIL_LEAST 1e-4

/* The result of looking at the components of a subsystem: the largest ratio, the share of its component, and the
 * largest share. */
typedef struct {
    double ratio, share, largest;
} tvi_tail_survey;

static inline double tvi_tail_share(const tvi_tail_part *part, bool has_masses)
{
    return (has_masses ? part->movement : part->momentum) * part->movement;
}

/* The ratio without the roundoff of a force, which is that of the positions, relative to their movement. 0 / 0 counts
 * as 0. There are no branches, since the larger of two numbers changes from step to step. */
static inline double tvi_tail_ratio(const tvi_tail_part *part)
{
    const double ratio_p = part->last_p * part->per_momentum, ratio_q = part->last_q * part->per_movement;
    const double known_q = part->last_q > 0 ? ratio_q : 0, ratio = ratio_p >= known_q ? ratio_p : known_q;
    const double roundoff = 32 * DBL_EPSILON * part->position * part->per_movement;
    const double rest = ratio - (part->position > 0 ? roundoff : 0);
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

/* Tells whether the largest ratio is the tail: its component has a share that counts in full. */
static inline bool tvi_tail_is_known(const tvi_tail_survey *survey)
{
    return survey->share >= TVI_TAIL_LEAST * survey->largest;
}

static inline double tvi_tail_of(double ratio, double share, double largest)
{
    const double least = TVI_TAIL_LEAST * largest, part = share * (1 / least);
    return ratio * (share < least ? part : 1);
}

/* Computes out[width], the tails of several members, from share and ratio [n][width]. */
static inline void tvi_tails_of_members(const tvi_subsystems *parts, int n, int width, const double *share,
                                        const double *ratio, double *out)
{
    double most[TVI_MOST_WIDTH];
    for (int m = 0; m < width; m++) most[m] = 0;
    for (int part = 0, k = 0; part < parts->count; part++) {
        const int first = k, end = tvi_subsystems_end(parts, part, n);
        double largest[TVI_MOST_WIDTH];
        for (int m = 0; m < width; m++) largest[m] = 0;
        for (; k < end; k++)
            for (int m = 0; m < width; m++) {
                const double one = share[tvi_subsystems_component(parts, k) * width + m];
                largest[m] = one > largest[m] ? one : largest[m];
            }
        for (k = first; k < end; k++)
            for (int m = 0; m < width; m++) {
                const int at = tvi_subsystems_component(parts, k) * width + m;
                const double tail = tvi_tail_of(ratio[at], share[at], largest[m]);
                most[m] = tail > most[m] ? tail : most[m];
            }
    }
    for (int m = 0; m < width; m++) out[m] = most[m];
}

#endif
