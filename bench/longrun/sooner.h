/* sooner.h - Declares the control of the rule that ends the passes: steps of this thread whose passes end as soon as
 * one moves nothing, or is small and moves no less than the one before it. The program has the library's steps with
 * this rule (longrun.mk). */
#ifndef SOONER_H
#define SOONER_H

#include "algebra/passes.h"

extern _Thread_local bool passes_end_sooner;

/* The square of how many times the rule's roundoff: first passes may grow. */
#define SOONER_SMALL 1024

static inline tvi_passes_verdict judge_sooner(tvi_convergence_test *passes, const tvi_stopping_rule *rule, double size)
{
    const double before = passes->size;
    const tvi_passes_verdict verdict = tvi_convergence_add_pass(passes, rule, size);
    if (!passes_end_sooner) return verdict;
    return size == 0 || (size >= before && size <= SOONER_SMALL * rule->roundoff_level) ? TVI_PASSES_MAY_END
                                                                                        : TVI_PASSES_GO_ON;
}
#define tvi_convergence_add_pass judge_sooner

#endif
