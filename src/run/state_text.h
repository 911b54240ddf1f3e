/* state_text.h - a state as text that every version, machine and instruction set reads. */
#ifndef TVI_SRC_RUN_STATE_TEXT_H
#define TVI_SRC_RUN_STATE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* The e is that of a rescaled system (start of a run: -H); a text need not have it. */
typedef struct {
    int n, parameters;
    bool has_e;
    double *value; /* [parameters] */
    double *state; /* [2n + 2][2] t, q[n], p[n] and e, each with its low-order part */
} tvi_state_text;

/* Memory for the numbers of such a state, which is to be freed by free(value). False: there is none. */
bool tvi_state_text_open(tvi_state_text *x, int n, int parameters);

/* How many characters the state has; they are written where text is not NULL. */
size_t tvi_state_text_write(const tvi_state_text *x, char *text);
/* Reads a state of this n and so many parameters. NULL, or why the text is none. */
const char *tvi_state_text_read(tvi_state_text *x, const char *text, size_t size);

#endif
