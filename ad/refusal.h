/* refusal.h - Keeps the text that explains the last refusal: an error status that the library returned, with its
 * reason. tvi_last_error returns this text. Each thread has its own text. Nothing is stored unless something is
 * refused. */
#ifndef TVI_AD_REFUSAL_H
#define TVI_AD_REFUSAL_H

#include "compiler.h"
#include "tape.h"

/* Sets the text from a printf-like format. The previous text may be one of the arguments. Returns the status. */
tvi_status jet_refuse(tvi_status status, const char *format, ...) JET_FORMAT(2, 3) JET_COLD;
/* Sets the text to "out of memory" if the status is TVI_ENOMEM. Returns the status. */
tvi_status jet_explain_out_of_memory(tvi_status status);
/* Returns the text, which is "" before the first refusal. */
const char *jet_last_refusal_text(void);

/* Sets the text that explains why an output, of `output_count` outputs with this name, is refused: it is poison, a
 * number that is not finite, or a jet of another graph. Returns the status. */
tvi_status jet_explain_refused_output(const char *name, int output_count, int output_index, jet x);

#endif
