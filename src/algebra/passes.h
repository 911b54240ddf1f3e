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
    int most, exactly; /* passes; exactly so many, whatever they show; 0: as many as needed */

    /* They end where the next correction is expected to be at most the goal: this one times the part that passes leave,
     * the slower of the last `memory` ones. A part that is not below `contraction` is none: as large as this one. */
    double goal;
    double early;      /* the goal of the first of many iterations that follow each other, where that is more */
    int memory;        /* 1 or 2 */
    bool is_quadratic; /* the part that a pass leaves is the square of what the one before it left; memory is 1 */
    double contraction;
    double far;                /* corrections above it show no part: they are as large as they are */
    double noise, first_noise; /* nor do those that may be roundoff, up to this; before any part is known, up to that */
    double most_slack;         /* how much slower than expected passes are believed to be; 0: it is not learned */
    double slack_above;        /* from corrections that are larger than this, which are no roundoff */
    double confirmed;          /* the pass that checks the expectation moves no more than this */

    /* They are stuck when more than this part of the correction before is left, and of the one before that, too, where
     * they are compared with two: corrections that follow from one another may be small and large in turns. */
    double stuck;
    int turns;       /* 1 or 2 */
    int patience;    /* the first passes, which are never stuck */
    double roundoff; /* a correction that is stuck is roundoff up to this, whatever the roundoff is */
} tvi_passes_rule;

/* What the passes have shown so far. */
typedef struct {
    int count;
    double size, before, earlier; /* of the corrections of the last three passes */
    double part, slowest;         /* that the last pass left, and the slower of those remembered; 0: not known */
    double shown;                 /* the last correction without its roundoff */
    double next;                  /* what the next one should be */
    double slack, seen;           /* how much slower passes are: believed, and by the last correction */
    double roundoff;              /* a correction of at most this is roundoff, as measured; 0: not measured */
    double early;                 /* the goal, where that is more: of the rule, or part of it */
    double curvature, typical;    /* the first pass leaves of its correction curvature times this, or typical, the
                                     larger one; 0: not known */
    bool checks;                  /* a pass more than seems needed, until one confirms what was expected of it */
} tvi_passes;

typedef enum {
    TVI_PASSES_GO_ON,
    TVI_PASSES_MAY_END, /* at the goal, or at roundoff */
    TVI_PASSES_STUCK    /* they have come to roundoff, or do not converge: the caller measures */
} tvi_passes_verdict;

static const tvi_passes TVI_NO_PASSES = {.size = INFINITY, .before = INFINITY, .earlier = INFINITY, .slack = 1};

/* The same, member by member: compilers clear a struct by an instruction that takes long to begin. */
static inline void tvi_passes_begin(tvi_passes *passes)
{
    passes->count = 0;
    passes->size = passes->before = passes->earlier = INFINITY;
    passes->part = passes->slowest = passes->shown = passes->next = passes->seen = passes->roundoff = passes->early = 0;
    passes->curvature = passes->typical = 0;
    passes->slack = 1;
    passes->checks = false;
}

/* What the iteration of this number may leave. */
static inline double tvi_passes_early(const tvi_passes_rule *rule, double number)
{
    return rule->early / (number * number);
}

/* ---- What the next correction should be -------------------------------------------------------------------------- */

static inline bool tvi_passes_contracts(const tvi_passes *passes, const tvi_passes_rule *rule)
{
    return passes->size <= rule->stuck * passes->before;
}

/* Passes that gain little where the first correction was small make later ones leave more than the first one did. The
 * slack that one correction shows is believed when the next one contracts again: one that was roundoff does not. */
static inline void tvi_passes_learn_slack(tvi_passes *passes, const tvi_passes_rule *rule)
{
    const bool shows = tvi_passes_contracts(passes, rule);
    if (shows) passes->slack = tvi_smaller(tvi_larger(passes->slack, passes->seen), rule->most_slack);
    const double slack = tvi_larger(passes->slack, passes->seen) * passes->size / passes->next;
    passes->seen = shows && passes->size > rule->slack_above ? slack : 0;
}

static inline bool tvi_passes_is_known(const tvi_passes *passes, const tvi_passes_rule *rule)
{
    return passes->slowest > 0 && passes->slowest < rule->contraction;
}

/* A correction before that is larger than 1 counts as 1: it says more of the unknown's size than of the passes. */
static inline void tvi_passes_show_part(tvi_passes *passes, const tvi_passes_rule *rule)
{
    const double part = passes->size / tvi_smaller(passes->before, 1);
    passes->slowest = rule->is_quadratic ? part * part : rule->memory > 1 ? tvi_larger(part, passes->part) : part;
    passes->part = part;
}

static inline double tvi_passes_part(const tvi_passes *passes, const tvi_passes_rule *rule)
{
    return tvi_passes_is_known(passes, rule) ? passes->slowest : 1;
}

/* As large as this one, if it is far. Each kind of correction goes a way of its own, which processors foresee. */
static inline void tvi_passes_expect(tvi_passes *passes, const tvi_passes_rule *rule)
{
    const double size = passes->size, shown = passes->shown;
    passes->shown = passes->next = size;
    if (size > rule->far) return;
    if (passes->count == 1) {
        if (passes->curvature > 0)
            passes->next = tvi_smaller(passes->curvature * tvi_larger(size, passes->typical), 1) * size;
    } else if (size <= (passes->slowest > 0 ? rule->noise : rule->first_noise)) {
        const double part = tvi_passes_part(passes, rule);
        passes->shown = tvi_smaller(size, part * shown);
        passes->next = tvi_larger(passes->slack, passes->seen) * part * passes->shown;
    } else {
        tvi_passes_show_part(passes, rule);
        passes->next = tvi_larger(passes->slack, passes->seen) * tvi_passes_part(passes, rule) * size;
    }
}

/* ---- The verdict ------------------------------------------------------------------------------------------------- */

static inline bool tvi_passes_is_stuck(const tvi_passes *passes, const tvi_passes_rule *rule)
{
    if (passes->count <= rule->patience || tvi_passes_contracts(passes, rule)) return false;
    const bool has_two = rule->turns > 1 && passes->count > 2;
    return !has_two || passes->size > rule->stuck * rule->stuck * passes->earlier;
}

/* The last bits go to and fro, and nothing else moves. */
static inline bool tvi_passes_is_cycle(const tvi_passes *passes)
{
    return passes->size == passes->before && passes->size == passes->earlier;
}

/* Roundoff, which grows and shrinks, of passes that are known to contract: they go on, stuck or not. */
static inline bool tvi_passes_is_quiet(const tvi_passes *passes, const tvi_passes_rule *rule)
{
    return passes->size <= tvi_smaller(rule->noise, rule->roundoff) && tvi_passes_is_known(passes, rule) &&
           passes->size != passes->before;
}

/* Adds a pass, whose correction is so large. */
static inline tvi_passes_verdict tvi_passes_judge(tvi_passes *passes, const tvi_passes_rule *rule, double size)
{
    const double goal = tvi_larger(rule->goal, passes->early);
    const bool is_confirmed = size == 0 || (passes->next <= goal && size <= rule->confirmed);
    passes->earlier = passes->before;
    passes->before = passes->size;
    passes->size = size;
    passes->count++;
    if (rule->exactly > 0) return passes->count == rule->exactly ? TVI_PASSES_MAY_END : TVI_PASSES_GO_ON;
    if (rule->most_slack > 0 && passes->count > 2) tvi_passes_learn_slack(passes, rule);
    tvi_passes_expect(passes, rule);
    const bool is_enough = passes->next <= goal && (is_confirmed || !passes->checks);
    if (is_enough || (passes->roundoff > 0 && size <= passes->roundoff)) return TVI_PASSES_MAY_END;
    if (tvi_passes_is_quiet(passes, rule) || !tvi_passes_is_stuck(passes, rule)) return TVI_PASSES_GO_ON;
    if (size > rule->roundoff) return TVI_PASSES_STUCK;
    return tvi_passes_is_known(passes, rule) && !tvi_passes_is_cycle(passes) ? TVI_PASSES_GO_ON : TVI_PASSES_MAY_END;
}

/* Those that were stuck: the roundoff is so large, as was measured since. */
static inline bool tvi_passes_are_roundoff(tvi_passes *passes, double roundoff)
{
    passes->roundoff = roundoff;
    return passes->size <= roundoff;
}

#endif
