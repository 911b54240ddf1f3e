/* refusal.h - Keeps the text of the last refusal in words. The text belongs to the thread, and costs nothing as long as
 * nothing is refused. */
#ifndef TVI_AD_REFUSAL_H
#define TVI_AD_REFUSAL_H

#include "compiler.h"
#include "tape.h"

/* Sets the text, which may quote the old one, and returns the status. */
tvi_status jet_refuse(tvi_status status, const char *format, ...) JET_FORMAT(2, 3) JET_COLD;
/* Sets the text for TVI_ENOMEM to its name. Returns the status. */
tvi_status jet_refuse_memory(tvi_status status);
/* The text; "" before the first refusal. */
const char *jet_refusal(void);

/* Explains why output i of `outputs` is refused: it is poison, a number that is not finite, or of another graph. */
tvi_status jet_refuse_output(const char *name, int outputs, int i, jet x);

#endif
