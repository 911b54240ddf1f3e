/* emit.h - Writes C code for a tape, which is a recorded function as a straight-line program (tape.h). The code
 * consists of sweeps: functions that compute the values and the derivatives of the recorded function. The compiler of
 * this code knows every size, slot and number of the tape as a constant. src/compiled/ calls it, and so do the files of
 * the methods that write generated steps (docs/compiled.md).
 *
 * The text begins with the source of the functions that compute each kind of operation, its rules (rule.h), to be
 * inlined. The generated code calls them in the order of the tape, with constants for arguments; each rule is therefore
 * written once (embed.awk). A run is a group of equal operations that one call computes. On
 * small tapes each sum is a run of its own. If only values are requested, each operation of any kind is a run of its
 * own. Values then stay in registers. Large tapes keep their runs of equal operations as loops, since the time to
 * compile them grows with the number of runs. */
#ifndef TVI_AD_EMIT_H
#define TVI_AD_EMIT_H

#include "tape.h"
#include "text.h"

/* The sweeps of a tape that are requested as generated code. The interpreter runs the sweeps that are not requested. */
typedef struct {
    const char *name_prefix; /* The prefix of all names in the generated text. */
    /* The numbers of lanes for which a function that computes values is written. A 0 ends the list. */
    int value_lane_counts[3];
    bool needs_series_sweep; /* Tells whether series with one lane are requested, besides values with one lane. */
} jet_emission_request;

/* Sets *merged to the sweeps of the generated code, and to those of the interpreter where the code has none. Returns
 * merged. */
const jet_sweeps *jet_merge_sweeps(jet_sweeps *merged, const jet_sweeps *interpreted, const jet_sweeps *generated);

/* Returns the source text of the rules, as an array of lines that ends with NULL. */
const char *const *jet_embedded_rule_c_source_lines(void);

/* Writes the source text of the rules. The generated text begins with it. */
void jet_emit_rule_source(jet_text *text);
/* Writes the definition `static const jet_sweeps NAME_sweeps`, which has NULL for sweeps that are not requested. NAME
 * is the name_prefix of the request. Other generated code can also use these names of the text: the tape NAME; the
 * function NAME_values_LANES(x) for each requested number of lanes, and for 2, 4 and 8; the numbers NAME_slots and
 * NAME_outputs (the counts of the tape); and NAME_is_split, which is 1 if each run is a single operation. */
void jet_emit_tape(jet_text *text, const jet_tape *tape, const jet_emission_request *request);

#endif
