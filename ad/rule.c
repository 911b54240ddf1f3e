/* The table of rules. */
#include "rule.h"

const jet_rule *const jet_rules[OP_COUNT] = {
    [OP_MUL] = &JET_RULE_OF(mul),     [OP_SQR] = &JET_RULE_OF(sqr),   [OP_DIV] = &JET_RULE_OF(div),
    [OP_SQRT] = &JET_RULE_OF(sqrt),   [OP_POW] = &JET_RULE_OF(pow),   [OP_EXP] = &JET_RULE_OF(exp),
    [OP_SIN] = &JET_RULE_OF(sin),     [OP_COS] = &JET_RULE_OF(cos),   [OP_SINH] = &JET_RULE_OF(sinh),
    [OP_COSH] = &JET_RULE_OF(cosh),   [OP_TAN] = &JET_RULE_OF(tan),   [OP_TANH] = &JET_RULE_OF(tanh),
    [OP_SECH2] = &JET_RULE_OF(sech2), [OP_LOG] = &JET_RULE_OF(log),   [OP_ASIN] = &JET_RULE_OF(asin),
    [OP_ACOS] = &JET_RULE_OF(acos),   [OP_ATAN] = &JET_RULE_OF(atan),
};
