/* pad.h - Lengthens the runs of a tape to whole vectors, which begin at multiples of eight slots. */
#ifndef TVI_AD_PAD_H
#define TVI_AD_PAD_H

#include "tape.h"

/* Repeats the last operation of runs whose length is nearly a multiple of eight, so that it becomes one, on tapes with
 * runs of eight operations or more. Sweeps go through a run in vectors, and three short vectors at its end take as long
 * as three whole ones. The operands of the copies are copied as well. Nothing reads the copies, so that their adjoints
 * are 0. Runs of whole vectors begin at a multiple of eight, as orders do; slots that are left over before them are
 * never read. Returns false without memory; the tape is then unchanged. */
bool jet_tape_pad(jet_tape *tape);

#endif
