/* passes.h - Decides when the passes of an iteration may end. Newton's method, the Galerkin passes, the Legendre
 * transforms and the solutions inside a step use this rule with different numbers (docs/method.md section 5 has them
 * all). */
#ifndef TVI_SRC_ALGEBRA_PASSES_H
#define TVI_SRC_ALGEBRA_PASSES_H

#include "algebra/sizes.h"

#include <float.h>

/* The largest fraction that a pass may leave without counting as stuck. */
#define TVI_PASSES_ALL (1 - DBL_EPSILON)

/* The rule of an iteration. Corrections are in the unit in which they are judged, absolute or relative. Fractions are
 * the ratios of successive corrections. A number that is 0 has no effect. */
typedef struct {
    /* The most passes, and the exact number of passes whatever they show; 0: as many as needed. */
    int most, exactly;
    double goal; /* passes end if the next correction is expected to be at most this */
    /* Corrections up to this may be roundoff, and do not show how passes contract. */
    double noise;
    /* Passes that leave at least this fraction of a correction are expected to leave all of it. */
    double contraction;
    /* Passes are stuck if they leave more than this fraction of the correction before. */
    double stuck;
    /* With 2, they also have to leave as much of the correction before that one: corrections may be alternately small
     * and large. */
    int period;
    /* The fraction that a pass leaves is the square of the one before, as in Newton's method. */
    bool is_quadratic;
} tvi_passes_rule;

typedef enum {
    TVI_PASSES_GO_ON,
    TVI_PASSES_MAY_END, /* at the goal, or at roundoff */
    TVI_PASSES_STUCK    /* at roundoff, or without convergence: the caller measures */
} tvi_passes_verdict;

/* Defines tvi_passes, the passes so far, and tvi_judge, which adds one. */
#define JUDGED(name)       tvi_##name
#define REAL               double
#define TRUTH              int
#define ABOVE(a, b)        ((a) > (b))
#define AT_MOST(a, b)      ((a) <= (b))
#define SAME(a, b)         ((a) == (b))
#define NOT(a)             (!(a))
#define IF(which, yes, no) ((which) ? (yes) : (no))
#include "algebra/judge.h"

/* Begins an iteration. The members are set one by one, since compilers clear a struct by an instruction that is slow to
 * start. slowest is 0 if no earlier iteration has measured it. */
static inline void tvi_passes_begin(tvi_passes *passes, double slowest)
{
    passes->count = 0;
    passes->size = passes->before = passes->earlier = INFINITY;
    passes->part = passes->shown = passes->next = passes->roundoff = 0;
    passes->slack = 1;
    passes->slowest = slowest;
}

/* Adds a pass with a correction of this size. */
static inline tvi_passes_verdict tvi_passes_judge(tvi_passes *passes, const tvi_passes_rule *rule, double size)
{
    int is_stuck;
    if (tvi_judge(passes, rule, size, &is_stuck)) return TVI_PASSES_MAY_END;
    return is_stuck ? TVI_PASSES_STUCK : TVI_PASSES_GO_ON;
}

/* Records the roundoff that was measured after the passes were stuck. Returns whether the last correction is
 * roundoff. */
static inline bool tvi_passes_are_roundoff(tvi_passes *passes, double roundoff)
{
    passes->roundoff = roundoff;
    return passes->size <= roundoff;
}

#endif
