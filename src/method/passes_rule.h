/* passes_rule.h - Combines the rule for an iteration's passes (algebra/passes.h) with the user's options. Steppers
 * call it when they prepare their tables (galerkin/probe.c, generating/newton.c). */
#ifndef TVI_SRC_METHOD_PASSES_RULE_H
#define TVI_SRC_METHOD_PASSES_RULE_H

#include "algebra/passes.h"
#include "tvi.h"

/* Returns the rule with the limits of passes from the options. A tolerance other than 0 replaces the goal of the
 * corrections, and has their unit. */
static inline tvi_passes_rule tvi_passes_rule_with_options(const tvi_passes_rule *rule, const tvi_options *options,
                                                           double tolerance)
{
    tvi_passes_rule requested = *rule;
    if (options->max_passes > 0) requested.max_passes = options->max_passes;
    if (options->passes > 0) requested.max_passes = requested.exact_passes = options->passes;
    if (tolerance > 0) {
        requested.correction_goal = tolerance;
        requested.max_trusted_ratio = 0;
    }
    return requested;
}

#endif
