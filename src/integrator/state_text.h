/* state_text.h - Writes a state as text, and reads it, in a format that every version, machine and instruction set
 * reads. travel.c calls it for tvi_state_to_text, tvi_state_from_text and their ensemble versions. */
#ifndef TVI_INTEGRATOR_STATE_TEXT_H
#define TVI_INTEGRATOR_STATE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* The numbers of a state that are written as text. In a rescaled system e is the constant -H at the start of the run; a
 * text may lack it. */
typedef struct {
    int n, parameter_count;
    bool has_energy_offset;   /* true if the text has the energy offset e of a rescaled system */
    double *parameter_values; /* [parameter_count] the values of the parameters */
    double *state_values;     /* [2n + 2][2] t, q[n], p[n] and e, each followed by its low-order part */
} tvi_state_text;

/* Allocates both arrays in one block, which the caller frees by free(parameter_values). Returns false if memory is
 * exhausted. */
bool tvi_state_text_open(tvi_state_text *state_text, int n, int parameter_count);

/* Writes the state to `text`, unless that is NULL. Returns the number of characters that the state needs. */
size_t tvi_state_text_write(const tvi_state_text *state_text, char *text);
/* Reads a state with the n and the parameter_count of state_text. Returns NULL, or a message that tells why the text is
 * not such a state. */
const char *tvi_state_text_read(tvi_state_text *state_text, const char *text, size_t size);

#endif
