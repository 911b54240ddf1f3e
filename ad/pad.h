/* pad.h - runs as long as whole vectors, which begin where these do. */
#ifndef TVI_AD_PAD_H
#define TVI_AD_PAD_H

#include "tape.h"

/* Of a tape with runs of eight operations or more, those of nearly a multiple of eight get their last one once more, so
 * often that it is one: sweeps go through a run in vectors, and three short ones at its end take as long as three whole
 * ones. What the copies are made of is copied as well. Nothing reads them, so that their adjoints are 0. Runs of whole
 * vectors begin at a multiple of eight, as orders do; slots before them that are left over are never read. false
 * without memory; the tape is as it was. */
bool jet_tape_pad(jet_tape *tape);

#endif
