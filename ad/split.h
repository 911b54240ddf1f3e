/* split.h - a tape whose operations stand alone, for generated code (emit.c): an interpreter gains by long runs, but a
 * compiler, which keeps a value in a register where it is read soon, loses by them. */
#ifndef TVI_AD_SPLIT_H
#define TVI_AD_SPLIT_H

#include "tape.h"

typedef enum {
    JET_SPLIT_NONE, /* as they are */
    JET_SPLIT_SUMS, /* sums of multiples, and runs whose operands are not adjacent */
    JET_SPLIT_ALL,  /* all, each behind what it reads and directly before what waits for it alone: values only */
    JET_SPLIT_PAIRS /* the same, and what pairs do to each other has the factor that sums have it with */
} jet_split;

/* The same slots by the same operations, those apart as runs of one; with JET_SPLIT_PAIRS products have the factor that
 * all sums have them with, but for their signs. Only the runs and their terms are its own, for jet_tape_free_split; all
 * else is the tape's. false without memory, and nothing is to be freed. */
bool jet_tape_split(jet_tape *split, const jet_tape *tape, jet_split which);
void jet_tape_free_split(jet_tape *split);

/* The slot that the run's operation i reads as its k-th one; -1: there are no more. */
int jet_read_by(const jet_tape *tape, const jet_run *run, int i, int k);

/* follows[slots]: of the inputs and constants, given; then of all others, whether any that they read follows. */
void jet_tape_follow(const jet_tape *tape, bool follows[]);

#endif
