/* split.h - Splits the runs of a tape into single operations for generated code (emit.c). Long runs are good for an
 * interpreter, but bad for a compiler, which keeps a value in a register only if it is read soon. */
#ifndef TVI_AD_SPLIT_H
#define TVI_AD_SPLIT_H

#include "tape.h"

/* Says which runs are split. */
typedef enum {
    JET_SPLIT_NONE, /* None: all runs stay as they are. */
    JET_SPLIT_SUMS, /* Splits LINEAR runs and runs with scattered operands. */
    /* Splits all runs, on tapes of values. Each operation then follows its operands, and directly precedes the
     * operations that need it alone. */
    JET_SPLIT_ALL,
    /* Splits all runs, and moves factors of sums over pair interactions (tape_split.c). */
    JET_SPLIT_PAIRS
} jet_split_mode;

/* Makes a tape with the same slots, whose runs are split. With JET_SPLIT_PAIRS, a factor with which all sums read a
 * product is moved into the product, except for its sign. The new tape owns only its runs and their terms, which
 * jet_free_split_tape frees; all other arrays belong to `tape`. Returns false if memory is lacking; nothing is to be
 * freed then. */
bool jet_split_tape_runs(jet_tape *split, const jet_tape *tape, jet_split_mode mode);
void jet_free_split_tape(jet_tape *split);

/* Returns the slot that an operation of a run reads as its operand of this number; -1: the operation has fewer
 * operands. Both are counted from 0. */
int jet_operation_operand_slot(const jet_tape *tape, const jet_run *run, int operation, int operand);

/* Sets depends[slots] of all computed slots. The caller has set it for the inputs and constants. A computed slot
 * depends if one of its operands does. */
void jet_tape_mark_dependents(const jet_tape *tape, bool depends[]);

#endif
