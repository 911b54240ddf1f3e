/* asked.h - the rule of an iteration's passes as the options have it. */
#ifndef TVI_SRC_METHOD_ASKED_H
#define TVI_SRC_METHOD_ASKED_H

#include "algebra/passes.h"
#include "tvi.h"

/* The tolerance of the options in the unit of the sizes. */
static inline tvi_passes_rule tvi_passes_rule_asked(const tvi_passes_rule *rule, const tvi_options *options,
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
