/* split.h - Splits the runs of a tape into single operations for generated code (emit.c). An interpreter gains by long
 * runs. A compiler loses by them, as it keeps a value in a register if the value is read soon. */
#ifndef TVI_AD_SPLIT_H
#define TVI_AD_SPLIT_H

#include "tape.h"

typedef enum {
    JET_SPLIT_NONE, /* runs stay as they are */
    JET_SPLIT_SUMS, /* sums of multiples, and runs whose operands are not adjacent */
    /* All runs. Each operation stands after what it reads, and directly before what waits for it alone. Values only. */
    JET_SPLIT_ALL,
    /* Everything that JET_SPLIT_ALL splits, with the factors of interactions between pairs moved. */
    JET_SPLIT_PAIRS
} jet_split;

/* Makes a tape with the same slots and operations, split into runs of one. With JET_SPLIT_PAIRS products get the factor
 * that all sums have them with, up to their signs. Only the runs and their terms are its own, for jet_tape_free_split;
 * the rest belongs to the tape. Returns false without memory, and nothing is to be freed. */
bool jet_tape_split(jet_tape *split, const jet_tape *tape, jet_split which);
void jet_tape_free_split(jet_tape *split);

/* The slot that the run's operation i reads as its k-th one; -1: there are no more. */
int jet_operand_slot(const jet_tape *tape, const jet_run *run, int i, int k);

/* Sets follows[slots] of each slot from those of the inputs and constants: whether the slot reads one that follows. */
void jet_tape_mark_dependents(const jet_tape *tape, bool follows[]);

#endif
