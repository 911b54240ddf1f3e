/* refusal.c - Keeps the text of the last refusal (refusal.h), and finds the operation at which a sweep has failed. */
#include "refusal.h"
#include "rule.h"
#include "text.h"

#include <stdarg.h>
#include <string.h>

enum { TEXT_MAX = 512 };
static _Thread_local char last[TEXT_MAX];

tvi_status jet_refuse(tvi_status status, const char *format, ...)
{
    char text[TEXT_MAX];
    va_list arguments;
    va_start(arguments, format);
    (void)jet_format_va_list(text, sizeof text, format, arguments);
    va_end(arguments);
    memcpy(last, text, sizeof text);
    return status;
}

tvi_status jet_explain_out_of_memory(tvi_status status)
{
    return status == TVI_ENOMEM ? jet_refuse(status, "out of memory") : status;
}

const char *jet_last_refusal_text(void) { return last; }

#define NAME(op, name) [op] = #name,
static const char *const operation_names[OP_COUNT] = {JET_RULE_LIST(NAME)};
#define REASON(reason, status, text) [reason] = text,
static const char *const reason_texts[] = {JET_REASON_LIST(REASON)};

tvi_status jet_explain_refused_output(const char *name, int output_count, int output_index, jet x)
{
    const jet_reason reason = jet_is_poison(x) ? jet_poison_reason(x) : x.node ? JET_FOREIGN : JET_NOT_FINITE;
    const tvi_status status = jet_reason_status(reason);
    char called[64];
    (void)jet_format(called, sizeof called, output_count > 1 ? "%s[%d]" : "%s", name, output_index);
    if (reason < JET_BEYOND_Q) return jet_refuse(status, "%s %s", called, reason_texts[reason]);
    if (reason < JET_OUTSIDE) return jet_refuse(status, "%s %s[%d]", called, reason_texts[reason], (int)x.number);
    return jet_refuse(status, "%s is made of jet_%s, which has no power series at %g", called,
                      operation_names[reason - JET_OUTSIDE], x.number);
}

/* Returns the value, in one lane, of the operand that is outside the domain of an operation of the run: the divisor of
 * a division, or the first operand of any other operation. */
static double value_of_operand_outside_domain(const jet_run_of_operations *run, const double *block, int lanes,
                                              int operation, int lane)
{
    return block[((run->op == OP_DIV ? run->b : run->a) + operation) * lanes + lane];
}

bool jet_explain_failed_sweep(const jet_tape *tape, double *block, int lanes)
{
    double z;
    /* Generated code does not store the values of all slots; the interpreter therefore computes all of them again. */
    (void)tape->interpreter_sweeps->values(tape, block, lanes);
    (void)jet_refuse(TVI_EDOMAIN, "an operation has no power series");
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++) {
        if (!operation_names[run->op]) continue;
        const double *a = block + (size_t)run->a * (size_t)lanes, *b = block + (size_t)run->b * (size_t)lanes;
        for (int i = 0; i < run->operation_count * lanes; i++) {
            if (jet_rules[run->op]->compute_values(run->exponent, 1, a + i, b + i, &z)) continue;
            const int operation = i / lanes;
            const bool is_part = tape->refusal.library_name &&
                                 tape->refusal.number_of_slot[run->z + operation] >= tape->refusal.first_library_number;
            const jet_op owner = tape->refusal.owner_of_slot[run->z + operation];
            (void)jet_refuse(TVI_EDOMAIN, "%s%sjet_%s%s%s has no power series at %g: operation %d of the recording",
                             is_part ? tape->refusal.library_name : "", is_part ? ": " : "", operation_names[run->op],
                             owner ? " in the derivatives of jet_" : "", owner ? operation_names[owner] : "",
                             value_of_operand_outside_domain(run, block, lanes, operation, i % lanes),
                             tape->refusal.number_of_slot[run->z + operation]);
            return false;
        }
    }
    return false;
}
