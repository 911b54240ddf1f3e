/* passes_rule.h - Combines the rule for an iteration's passes with the user's options. */
#ifndef TVI_SRC_METHOD_PASSES_RULE_H
#define TVI_SRC_METHOD_PASSES_RULE_H

#include "algebra/passes.h"
#include "tvi.h"

/* The rule with the options' limits of passes, and with a tolerance in the unit of the corrections. */
static inline tvi_passes_rule tvi_passes_rule_with_options(const tvi_passes_rule *rule, const tvi_options *options,
                                                           double tolerance)
{
    tvi_passes_rule asked = *rule;
    if (options->max_passes > 0) asked.most = options->max_passes;
    if (options->passes > 0) asked.most = asked.exactly = options->passes;
    if (tolerance > 0) {
        asked.goal = tolerance;
        asked.contraction = 0;
    }
    return asked;
}

#endif
