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

/* What the passes have shown so far. */
typedef struct {
    int count;
    double size, before, earlier; /* of the corrections of the last three passes */
    double part, slowest; /* that the last pass left which showed it, and the slower of the last two, at first that of
                             an earlier iteration; 0: not known */
    double shown;         /* the last correction without its roundoff, */
    double next;          /* what the next one should be, */
    double slack;         /* and how much more it is taken to be: 1, but for Newton's method (generating/newton.h) */
    double roundoff;      /* a correction of at most this is roundoff, as measured; 0: not measured */
} tvi_passes;

typedef enum {
    TVI_PASSES_GO_ON,
    TVI_PASSES_MAY_END, /* at the goal, or at roundoff */
    TVI_PASSES_STUCK    /* they have come to roundoff, or do not converge: the caller measures */
} tvi_passes_verdict;

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

/* A correction before that is larger than 1 counts as 1: it says more of the unknown's size than of the passes. */
static inline void tvi_passes_show_part(tvi_passes *passes, const tvi_passes_rule *rule)
{
    const double part = passes->size / tvi_smaller(passes->before, 1);
    passes->slowest = rule->is_quadratic ? part * part : tvi_larger(part, passes->part);
    passes->part = part;
}

static inline bool tvi_passes_is_known(const tvi_passes *passes, const tvi_passes_rule *rule)
{
    return passes->slowest > 0 && passes->slowest < rule->contraction;
}

/* Roundoff is taken to shrink as corrections above it did; of a first correction
 * above it nothing is known. */
static inline void tvi_passes_expect(tvi_passes *passes, const tvi_passes_rule *rule)
{
    const bool is_first = passes->count == 1, is_loud = passes->size > rule->noise;
    if (is_loud && !is_first) tvi_passes_show_part(passes, rule);
    const double part = tvi_passes_is_known(passes, rule) ? passes->slowest : 1;
    passes->shown = is_loud || is_first ? passes->size : tvi_smaller(passes->size, part * passes->shown);
    passes->next = is_loud && is_first ? passes->size : passes->slack * part * passes->shown;
}

/* Roundoff of passes that are known to contract grows and shrinks. */
static inline bool tvi_passes_is_stuck(const tvi_passes *passes, const tvi_passes_rule *rule)
{
    if (passes->count <= rule->turns || !(passes->size > rule->stuck * passes->before)) return false;
    if (passes->size <= rule->noise && tvi_passes_is_known(passes, rule)) return false;
    return rule->turns < 2 || passes->size > rule->stuck * rule->stuck * passes->earlier;
}

/* The last bits go to and fro, and nothing else moves. */
static inline bool tvi_passes_is_cycle(const tvi_passes *passes, const tvi_passes_rule *rule)
{
    return passes->size == passes->before && passes->size == passes->earlier && passes->size <= rule->noise;
}

/* Adds a pass, whose correction is so large. */
static inline tvi_passes_verdict tvi_passes_judge(tvi_passes *passes, const tvi_passes_rule *rule, double size)
{
    passes->earlier = passes->before;
    passes->before = passes->size;
    passes->size = size;
    passes->count++;
    if (rule->exactly > 0) return passes->count == rule->exactly ? TVI_PASSES_MAY_END : TVI_PASSES_GO_ON;
    tvi_passes_expect(passes, rule);
    if (passes->next <= rule->goal || size <= passes->roundoff) return TVI_PASSES_MAY_END;
    if (tvi_passes_is_cycle(passes, rule)) return TVI_PASSES_MAY_END;
    return tvi_passes_is_stuck(passes, rule) ? TVI_PASSES_STUCK : TVI_PASSES_GO_ON;
}

/* Those that were stuck: the roundoff is so large, as was measured since. */
static inline bool tvi_passes_are_roundoff(tvi_passes *passes, double roundoff)
{
    passes->roundoff = roundoff;
    return passes->size <= roundoff;
}

#endif
