/* pad.h - Lengthens the runs of a tape to whole vectors of eight, which begin at slots that are multiples of eight.
 * tape.c calls it. */
#ifndef TVI_AD_PAD_H
#define TVI_AD_PAD_H

#include "tape.h"

/* Repeats the last operation of each run whose length is just below a multiple of eight, on tapes with runs of eight
 * operations or more. Sweeps process a run in vectors, and the three short vectors at its end (4, 2, 1) take as long as
 * three whole ones. The operands of the repeated operations are copied, too. Nothing reads the repeated results, whose
 * adjoints are therefore 0. Runs of whole vectors begin at slots that are multiples of eight, as each order of a block
 * does; slots that this leaves empty are never read. Returns false if memory is lacking; the tape is then unchanged. */
bool jet_pad_tape_runs(jet_tape *tape);

#endif
