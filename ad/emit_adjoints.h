/* emit_adjoints.h - Writes the adjoint functions of generated code; emit.c calls it. The contributions of adjacent
 * sums to an operand are summed in one statement. */
#ifndef TVI_AD_EMIT_ADJOINTS_H
#define TVI_AD_EMIT_ADJOINTS_H

#include "tape.h"
#include "text.h"

/* Tells whether a run is a single sum, on a tape on which each sum is a run of its own. */
static inline bool jet_is_single_sum(const jet_run *run) { return run->op == OP_LINEAR && run->operation_count == 1; }

/* Return the first sum in the sequence of adjacent sums that contains `run`, and the end of the sequence that begins
 * with `first`. No sum of a sequence reads another one. */
const jet_run *jet_first_adjacent_sum(const jet_tape *tape, const jet_run *run);
const jet_run *jet_end_of_adjacent_sums(const jet_tape *tape, const jet_run *first);

/* Writes the functions NAME_sums_back_i(bar), which compute the adjoints of the adjacent sums from run i on. */
void jet_emit_adjoints(jet_text *text, const jet_tape *tape, const char *name);

#endif
