/* refusal.h - what was refused last, in words. The text belongs to the thread; it costs nothing where nothing is
 * refused. */
#ifndef TVI_AD_REFUSAL_H
#define TVI_AD_REFUSAL_H

#include "compiler.h"
#include "tape.h"

/* Sets the text, of which the old one may be a part, and returns the status. */
tvi_status jet_refuse(tvi_status status, const char *format, ...) JET_FORMAT(2, 3) JET_COLD;
/* TVI_ENOMEM has no other text than that of its name. Returns the status. */
tvi_status jet_refuse_memory(tvi_status status);
/* "" before the first refusal. */
const char *jet_refusal(void);

/* Says why the jet, output i of so many of a graph, is no output of it: it is poison, a number that is not finite, or
 * of another graph. */
tvi_status jet_refuse_output(const char *name, int outputs, int i, jet x);

#endif
