/* emit.h - a tape's sweeps as C text, for a compiler that then knows every size, slot and number of the tape.
 *
 * The text begins with that of the rules themselves (embed.awk), which are functions made inline there; generated code
 * is calls of them, in the order of the tape, with constants for arguments. So each rule exists once. Small tapes have
 * their orders unrolled and their sums apart, or, of values alone, all operations, so that values stay in registers;
 * large ones keep their runs of equal operations as loops, so that the time to compile grows with the number of runs
 * and not with that of operations. */
#ifndef TVI_AD_EMIT_H
#define TVI_AD_EMIT_H

#include "tape.h"
#include "text.h"

/* What generated code has of a tape; it leaves all else to the tape's interpreter. */
typedef struct {
    const char *name;              /* what it defines begins with */
    int lanes[3], directions[3];   /* of values and tangents; 0 ends */
    int top;                       /* the highest order, of what follows and of tangents */
    int beside;                    /* vectors of tangents that others have beside each order */
    bool has_series, has_adjoints; /* of one lane */
    bool is_force;                 /* values may be made with the factors of pairs moved (split.h) */
} jet_emission;

/* *merged = the code's sweeps, and for those that it has not the tape's own; returns it. */
const jet_sweeps *jet_sweeps_merge(jet_sweeps *merged, const jet_sweeps *interpreted, const jet_sweeps *code);

/* The lines of the rules; NULL ends them. */
const char *const *jet_emit_lines(void);

/* What all that follows is made of: once, at the beginning. */
void jet_emit_rules(jet_text *text);
/* Defines `static const jet_sweeps NAME_sweeps`, with NULL for what it has not, and what it needs; for others NAME, the
 * tape, NAME_values_LANES(x) for each number of lanes that is wanted, and for those of one register, 2, 4 and 8,
 * NAME_series_of(x, k) and NAME_tangents_of(x, dx, k, lanes), if it has one lane, to be inlined with constants,
 * NAME_clear(bar), if it has adjoints (emit_adjoints.h), and NAME_ORDERS(ORDER): ORDER(k) for all orders of a series.
 */
void jet_emit_tape(jet_text *text, const jet_tape *tape, const jet_emission *wanted);

#endif
