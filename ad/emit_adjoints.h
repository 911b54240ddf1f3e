/* emit_adjoints.h - Writes the adjoints of generated code. For sums in a row, each operand collects what all sums
 * contribute to it. The first contribution to a slot is an assignment, so that the slot need not be cleared before. */
#ifndef TVI_AD_EMIT_ADJOINTS_H
#define TVI_AD_EMIT_ADJOINTS_H

#include "tape.h"
#include "text.h"

/* Tells whether a run is a sum, on a tape whose sums stand alone. */
static inline bool jet_is_sum(const jet_run *run) { return run->op == OP_LINEAR && run->count == 1; }

/* The first sum in the row of sums that contains the sum `run`, and the end of this row. No sum in it reads another. */
const jet_run *jet_first_sum(const jet_tape *tape, const jet_run *run);
const jet_run *jet_end_of_sums(const jet_tape *tape, const jet_run *first);

/* Writes NAME_sums_back_i(bar), the adjoints of the sums from run i on, and NAME_clear(bar). NAME_clear is called for
 * all orders before anything is added to other slots than the inputs, which it leaves alone. Sets jet_run.fresh. */
void jet_emit_adjoints(jet_text *text, const jet_tape *tape, const char *name);

#endif
