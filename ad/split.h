/* split.h - Splits the runs of a tape, which are loops over equal operations, into single operations for generated code
 * (emit.c). Long runs are good for an interpreter, but bad for the compiler of generated code, which keeps a value in a
 * register only if it is read soon. */
#ifndef TVI_AD_SPLIT_H
#define TVI_AD_SPLIT_H

#include "tape.h"

/* Says which runs are split. */
typedef enum {
    JET_SPLIT_NONE, /* Leaves all runs of the tape as they are. */
    JET_SPLIT_SUMS, /* Makes single operations of all runs of sums (LINEAR). Other runs stay as they are. */
    /* Splits all runs, on tapes of values. Each operation follows its operands, and is followed directly by those
     * operations whose operands are then all computed. */
    JET_SPLIT_ALL
} jet_runs_to_split;

/* Makes a tape with the same slots, whose runs are split. The new tape owns only its runs and their terms, which
 * jet_free_split_tape frees; all other arrays belong to `tape`. Returns false if memory is lacking; nothing is to be
 * freed then. */
bool jet_tape_split_runs(jet_tape *split, const jet_tape *tape, jet_runs_to_split runs_to_split);
void jet_free_split_tape(jet_tape *split);

/* Returns the slot of the given operand of an operation of the run; -1: the operation has fewer operands. Operations
 * and operands are counted from 0. */
int jet_operation_operand_slot(const jet_tape *tape, const jet_run_of_operations *run, int operation_index,
                               int operand_index);

/* Finds the slots that depend on given inputs or constants, for which the caller has set is_dependent. A computed slot
 * is dependent if one of its operands is. */
void jet_tape_mark_dependents(const jet_tape *tape, bool is_dependent[]);

#endif
