/* emit.h - Writes a tape's sweeps as C text. The compiler of this text knows every size, slot and number of the tape.
 * src/compiled/ calls it.
 *
 * The text begins with the rules themselves (embed.awk), as functions to be inlined. The generated code calls these
 * functions in the order of the tape, with constants for arguments, so that each rule exists once. Small tapes have
 * their orders unrolled, and their sums apart, or for values alone all operations, so that values stay in registers.
 * Large tapes keep their runs of equal operations as loops: the time to compile them grows with the number of runs, and
 * not with that of operations. */
#ifndef TVI_AD_EMIT_H
#define TVI_AD_EMIT_H

#include "tape.h"
#include "text.h"

/* The parts of a tape that are wanted as generated code. The interpreter runs all others. */
typedef struct {
    const char *name;              /* prefix of all names */
    int lanes[3], directions[3];   /* of values and of tangents; 0 ends each */
    int top;                       /* the highest order */
    int tangent_vectors;           /* vectors of tangents that others have beside each order */
    bool has_series, has_adjoints; /* of one lane */
    bool is_force;                 /* values may be made with the factors of pairs moved (split.h) */
} jet_emission;

/* Sets *merged to the code's sweeps, and to the interpreter's where the code has none. Returns merged. */
const jet_sweeps *jet_sweeps_merge(jet_sweeps *merged, const jet_sweeps *interpreted, const jet_sweeps *code);

/* The lines of the rules; NULL ends them. */
const char *const *jet_emit_lines(void);

/* Writes the rules, once, at the beginning of the text. */
void jet_emit_rules(jet_text *text);
/* Writes `static const jet_sweeps NAME_sweeps`, with NULL for sweeps that are not wanted. For other generated code it
 * also defines NAME, the tape; NAME_values_LANES(x) for each wanted number of lanes, and for 2, 4 and 8; with one lane
 * NAME_series_of(x, k) and NAME_tangents_of(x, dx, k, lanes), to be inlined with constants; with adjoints
 * NAME_clear(bar) (emit_adjoints.h); and NAME_ORDERS(ORDER), which calls ORDER(k) for all orders of a series. */
void jet_emit_tape(jet_text *text, const jet_tape *tape, const jet_emission *wanted);

#endif
