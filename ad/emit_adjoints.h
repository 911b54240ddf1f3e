/* emit_adjoints.h - the adjoints of generated code: of sums in a row each operand gathers what all of them hand on to
 * it, and what is the first to be added to a slot is written there, so that no 0 has to stand in it before. */
#ifndef TVI_AD_EMIT_ADJOINTS_H
#define TVI_AD_EMIT_ADJOINTS_H

#include "tape.h"
#include "text.h"

/* Of a tape whose sums stand alone. */
static inline bool jet_is_sum(const jet_run *run) { return run->op == OP_LINEAR && run->count == 1; }

/* The first of the sums in a row, of which none reads another, that the sum `run` is one of; and where they end. */
const jet_run *jet_first_sum(const jet_tape *tape, const jet_run *run);
const jet_run *jet_end_of_sums(const jet_tape *tape, const jet_run *first);

/* NAME_sums_back_i(bar), the adjoints of the sums from run i on, and NAME_clear(bar), to be called for all orders
 * before anything is added to any but the inputs, which it leaves alone. Sets jet_run.fresh. */
void jet_emit_adjoints(jet_text *text, const jet_tape *tape, const char *name);

#endif
