/* probe.h - Declares the rules of the passes of a Galerkin step, and measures the roundoff of a pass (docs/method.md
 * section 5). */
#ifndef TVI_SRC_GALERKIN_PROBE_H
#define TVI_SRC_GALERKIN_PROBE_H

#include "galerkin/field.h"
#include "system/roundoff.h"

/* The work for measuring the roundoff of a pass. */
typedef struct {
    tvi_roundoff of_field;
    double *before, *displaced; /* [rows][lanes] */
    double *base, *impulse;     /* [unknowns][lanes] */
} galerkin_probe;

void tvi_galerkin_probe_take(galerkin_probe *probe, tvi_arena *arena, const galerkin_field *field);

/* The rule for all numbers of a step, from that for one unknown at one node, with the options. */
tvi_passes_rule tvi_galerkin_rule(const tvi_passes_rule *of_one, int numbers, const tvi_options *options);

/* Tells whether the nodes have not run off (roundoff.h). */
bool tvi_galerkin_is_near(const galerkin_field *field, const tvi_origin *origin);

/* Makes the next pass, which moves the unknowns by *moved, and measures its roundoff: the difference to a pass from
 * displaced unknowns, with displaced values of the field. Both results are squares as the passes have them. */
TVI_NODISCARD tvi_status tvi_galerkin_measure(galerkin_field *field, galerkin_probe *probe, double *moved,
                                              double *roundoff, tvi_stats *stats);

#endif
