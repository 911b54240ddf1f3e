/* emit.h - Writes the sweeps of a tape as C text. The compiler of this text then knows every size, slot and number of
 * the tape as a constant. src/compiled/ and the generated steps of the methods call it (docs/compiled.md).
 *
 * The text begins with the source of the rules themselves (embed.awk), as functions to be inlined. The generated code
 * calls these functions in the order of the tape, with constants for arguments. Each rule is therefore written once. On
 * small tapes each sum is a run of its own; if only values are requested, each operation is. Values then stay in
 * registers. Large tapes keep their runs of equal operations as loops, since the time to compile them grows with the
 * number of runs. */
#ifndef TVI_AD_EMIT_H
#define TVI_AD_EMIT_H

#include "tape.h"
#include "text.h"

/* The parts of a tape that generated code is to compute. The interpreter runs all others. */
typedef struct {
    const char *name_prefix; /* Prefix of all names in the generated text. */
    /* One value function is written for each of these numbers of lanes, and one tangent function for each of these
     * numbers of directions; a 0 ends each list. */
    int lane_counts[3], direction_counts[3];
    int top_order;                 /* Highest order of the series. */
    bool has_series, has_adjoints; /* Requests the sweep of series, and that of adjoints, with one lane. */
} jet_emission_request;

/* Sets *merged to the sweeps of the generated code, and to those of the interpreter where the code has none. Returns
 * merged. */
const jet_sweeps *jet_merge_sweeps(jet_sweeps *merged, const jet_sweeps *interpreted, const jet_sweeps *generated);

/* Returns the source text of the rules, as an array of lines that ends with NULL. */
const char *const *jet_rule_source_lines(void);

/* Writes the source text of the rules. The generated text begins with it. */
void jet_emit_rule_source(jet_text *text);
/* Writes the definition `static const jet_sweeps NAME_sweeps`, which has NULL for sweeps that are not requested. For
 * other generated code it also defines the tape NAME; NAME_values_LANES(x) for each requested number of lanes and for
 * 2, 4 and 8; for one lane NAME_series_of(x, k) and NAME_tangents_of(x, dx, k, lanes), to be inlined with constants;
 * and the numbers NAME_top, the top_order of the request, NAME_slots and
 * NAME_outputs, the counts of the tape, and NAME_is_split, 1 if each operation is a run of its own. */
void jet_emit_tape(jet_text *text, const jet_tape *tape, const jet_emission_request *request);

#endif
