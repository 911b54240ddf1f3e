/* passes.h - when the passes of an iteration may end: one vocabulary for Newton's method, the Galerkin passes, the
 * Legendre transforms and the solutions inside a step (docs/method.md section 5). */
#ifndef TVI_SRC_ALGEBRA_PASSES_H
#define TVI_SRC_ALGEBRA_PASSES_H

#include <math.h>
#include <stdbool.h>

/* Sizes of the corrections of the last three passes; INFINITY: there was none. */
typedef struct {
    double size, before, earlier;
} tvi_passes;

static const tvi_passes TVI_NO_PASSES = {INFINITY, INFINITY, INFINITY};

static inline void tvi_passes_add(tvi_passes *passes, double size)
{
    *passes = (tvi_passes){size, passes->size, passes->before};
}

/* Contraction: what the last pass has left of the correction before it; 0 after the first one. */
static inline double tvi_passes_contraction(const tvi_passes *passes) { return passes->size / passes->before; }

/* Whether the last pass has left at most this part; a NaN is no part. */
static inline bool tvi_passes_contract(const tvi_passes *passes, double part)
{
    return passes->size <= part * passes->before;
}

/* The same of the last two passes together: corrections of q follow from those of p and these from those of q, where
 * they are small and large in turns. */
static inline bool tvi_passes_contract_in_two(const tvi_passes *passes, double part)
{
    return passes->earlier < INFINITY && passes->size <= part * passes->earlier;
}

/* What an iteration asks of its passes, in the unit of the sizes. */
typedef struct {
    double goal;        /* a correction that may be left out */
    double contraction; /* a pass that leaves more than this part is stuck */
    double roundoff;    /* a correction that is stuck is roundoff up to this, whatever the roundoff is */
} tvi_passes_rule;

typedef enum {
    TVI_PASSES_GO_ON,
    TVI_PASSES_MAY_END, /* at the goal, or at roundoff */
    TVI_PASSES_STUCK    /* they have come to roundoff, or do not converge: the caller measures */
} tvi_passes_verdict;

static inline tvi_passes_verdict tvi_passes_judge(const tvi_passes *passes, const tvi_passes_rule *rule)
{
    if (passes->size <= rule->goal) return TVI_PASSES_MAY_END;
    if (!(passes->size >= rule->contraction * passes->before)) return TVI_PASSES_GO_ON;
    return passes->size <= rule->roundoff ? TVI_PASSES_MAY_END : TVI_PASSES_STUCK;
}

#endif
