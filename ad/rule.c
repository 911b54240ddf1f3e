/* The table of rules. */
#include "rule.h"

#define RULE(name, role)                                                                                               \
    {                                                                                                                  \
        role, jet_##name##_value, jet_##name##_series, jet_##name##_tangent, jet_##name##_pull                         \
    }

const jet_rule jet_rules[OP_COUNT] = {
    [OP_MUL] = RULE(mul, B_OPERAND),
    [OP_SQR] = RULE(sqr, B_NONE),
    [OP_DIV] = RULE(div, B_OPERAND),
    [OP_SQRT] = RULE(sqrt, B_NONE),
    [OP_POW] = RULE(pow, B_NONE),
    [OP_EXP] = RULE(exp, B_PARTNER),
    [OP_SIN] = RULE(sin, B_PARTNER),
    [OP_COS] = RULE(cos, B_PARTNER),
    [OP_SINH] = RULE(sinh, B_PARTNER),
    [OP_COSH] = RULE(cosh, B_PARTNER),
    [OP_TAN] = RULE(tan, B_PARTNER),
    [OP_TANH] = RULE(tanh, B_PARTNER),
    [OP_SECH2] = RULE(sech2, B_PARTNER_SERIES),
    [OP_LOG] = RULE(log, B_PARTNER),
    [OP_ASIN] = RULE(asin, B_PARTNER),
    [OP_ACOS] = RULE(acos, B_PARTNER),
    [OP_ATAN] = RULE(atan, B_PARTNER),
};
