/* passes.h - when the passes of an iteration may end: one rule for Newton's method, the Galerkin passes, the Legendre
 * transforms and the solutions inside a step, which differ in its numbers (docs/method.md section 5 has them all). */
#ifndef TVI_SRC_ALGEBRA_PASSES_H
#define TVI_SRC_ALGEBRA_PASSES_H

#include "algebra/sizes.h"

#include <float.h>

/* As a part that is left: all of it, or more. */
#define TVI_PASSES_ALL (1 - DBL_EPSILON)

/* What an iteration asks of its passes. Sizes of corrections are in the unit in which they are judged: absolute or
 * relative; the parts that passes leave are ratios of them. What is left out is 0, and asks for nothing. */
typedef struct {
    int most, exactly;  /* passes; exactly so many, whatever they show; 0: as many as needed */
    double goal;        /* they end where the next correction is expected to be at most this */
    double noise;       /* corrections up to this may be roundoff, and do not show how passes contract */
    double contraction; /* passes that leave this part of a correction, or more, are expected to leave all of it */
    double stuck;       /* they no longer shrink where more than this part is left of the correction before, */
    int turns;          /* and, of 2, of the one before that: those that follow from one another may be small and large
                           in turns */
    bool is_quadratic;  /* Newton's method: the part that a pass leaves is the square of what the one before it left */
} tvi_passes_rule;

typedef enum {
    TVI_PASSES_GO_ON,
    TVI_PASSES_MAY_END, /* at the goal, or at roundoff */
    TVI_PASSES_STUCK    /* they have come to roundoff, or do not converge: the caller measures */
} tvi_passes_verdict;

/* The passes so far: tvi_passes, and tvi_judge adds one. */
#define JUDGED(name)       tvi_##name
#define REAL               double
#define TRUTH              int
#define ABOVE(a, b)        ((a) > (b))
#define AT_MOST(a, b)      ((a) <= (b))
#define SAME(a, b)         ((a) == (b))
#define NOT(a)             (!(a))
#define IF(which, yes, no) ((which) ? (yes) : (no))
#include "algebra/judge.h"

/* Member by member: compilers clear a struct by an instruction that takes long to begin. slowest: 0 where it is not
 * known of an earlier iteration. */
static inline void tvi_passes_begin(tvi_passes *passes, double slowest)
{
    passes->count = 0;
    passes->size = passes->before = passes->earlier = INFINITY;
    passes->part = passes->shown = passes->next = passes->roundoff = 0;
    passes->slack = 1;
    passes->slowest = slowest;
}

/* Adds a pass, whose correction is so large. */
static inline tvi_passes_verdict tvi_passes_judge(tvi_passes *passes, const tvi_passes_rule *rule, double size)
{
    int is_stuck;
    if (tvi_judge(passes, rule, size, &is_stuck)) return TVI_PASSES_MAY_END;
    return is_stuck ? TVI_PASSES_STUCK : TVI_PASSES_GO_ON;
}

/* Those that were stuck: the roundoff is so large, as was measured since. */
static inline bool tvi_passes_are_roundoff(tvi_passes *passes, double roundoff)
{
    passes->roundoff = roundoff;
    return passes->size <= roundoff;
}

#endif
