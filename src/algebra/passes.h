/* passes.h - when the passes of an iteration may end: one rule for Newton's method, the Galerkin passes, the Legendre
 * transforms and the solutions inside a step, which differ in its numbers (docs/method.md section 5 has them all). */
#ifndef TVI_SRC_ALGEBRA_PASSES_H
#define TVI_SRC_ALGEBRA_PASSES_H

#include "tvi.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

/* As a part that is left: all of it, or more. */
#define TVI_PASSES_ALL (1 - DBL_EPSILON)

/* What an iteration asks of its passes. Sizes of corrections are in the unit in which they are judged: absolute or
 * relative; the parts that passes leave are ratios of them. What is left out is 0, and asks for nothing. */
typedef struct {
    int most, exactly; /* passes; exactly so many, whatever they show; 0: as many as needed */

    /* They end where the next correction is expected to be at most the goal: this one times the part that passes leave,
     * the slower of the last `memory` ones. A part that is not below `contraction` is none: as large as this one. */
    double goal;
    int memory; /* 1 or 2 */
    double contraction;
    double far;                /* corrections above it show no part: they are as large as they are */
    double noise, first_noise; /* nor do those that may be roundoff, up to this; before any part is known, up to that */
    double most_slack;         /* how much slower than expected passes are believed to be; 0: it is not learned */
    double slack_above;        /* from corrections that are larger than this, which are no roundoff */

    /* They are stuck when more than this part of the correction before is left, and of the one before that, too, where
     * they are compared with two: corrections that follow from one another may be small and large in turns. */
    double stuck;
    int turns;       /* 1 or 2 */
    int patience;    /* the first passes, which are never stuck */
    double roundoff; /* a correction that is stuck is roundoff up to this, whatever the roundoff is */
} tvi_passes_rule;

/* The same as the options have it; their tolerance in the unit of the sizes. */
tvi_passes_rule tvi_passes_rule_asked(const tvi_passes_rule *rule, const tvi_options *options, double tolerance);

/* What the passes have shown so far. */
typedef struct {
    int count;
    double size, before, earlier; /* of the corrections of the last three passes */
    double part, slowest;         /* that the last pass left, and the slower of those remembered; 0: not known */
    double shown;                 /* the last correction without its roundoff */
    double next;                  /* what the next one should be */
    double slack, seen;           /* how much slower passes are: believed, and by the last correction */
    double roundoff;              /* a correction of at most this is roundoff, as measured; 0: not measured */
    bool checks;                  /* one pass more than seems needed, to see how far the expectation can be trusted */
} tvi_passes;

typedef enum {
    TVI_PASSES_GO_ON,
    TVI_PASSES_MAY_END, /* at the goal, or at roundoff */
    TVI_PASSES_STUCK    /* they have come to roundoff, or do not converge: the caller measures */
} tvi_passes_verdict;

static const tvi_passes TVI_NO_PASSES = {.size = INFINITY, .before = INFINITY, .earlier = INFINITY, .slack = 1};

/* Adds a pass, whose correction is so large. */
tvi_passes_verdict tvi_passes_judge(tvi_passes *passes, const tvi_passes_rule *rule, double size);

/* Those that were stuck: the roundoff is so large, as was measured since. */
static inline bool tvi_passes_are_roundoff(tvi_passes *passes, double roundoff)
{
    passes->roundoff = roundoff;
    return passes->size <= roundoff;
}

#endif
