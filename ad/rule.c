/* rule.c - Defines the table of rules, which rule.h declares. */
#include "rule.h"

#define RULE(op, name) [op] = &JET_RULE_OF(name),
const jet_rule *const jet_rules[OP_COUNT] = {JET_RULE_LIST(RULE)};
