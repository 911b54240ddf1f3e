/* probe.h - Declares the rules that end the passes of a Galerkin step, and the function that measures the roundoff
 * of a pass (docs/method.md section 5). */
#ifndef TVI_SRC_GALERKIN_PROBE_H
#define TVI_SRC_GALERKIN_PROBE_H

#include "galerkin/field.h"
#include "system/roundoff.h"

/* The memory for measuring the roundoff of a pass. */
typedef struct {
    tvi_roundoff value_displacements;
    /* [pass_input_row_count][lanes] The values of the nodes before a pass, and after a pass from displaced values. */
    double *values_before_pass, *values_of_displaced_pass;
    /* [unknowns][lanes] Copies of drift_values_low and of the impulses of the nodes. */
    double *saved_drift_values_low, *saved_impulses;
} galerkin_roundoff_probe;

void tvi_galerkin_allocate_probe(galerkin_roundoff_probe *probe, tvi_arena *arena, const galerkin_field *field);

/* Returns the rule for all value_count unknowns at all nodes of a step, from the rule for a single one and from the
 * user's options. */
tvi_passes_rule tvi_galerkin_scale_passes_rule(const tvi_passes_rule *unknown_rule, int value_count,
                                               const tvi_options *options);

/* Returns whether the nodes are still near the start of the step (tvi_roundoff_is_motion_small of roundoff.h), and have
 * not diverged. */
bool tvi_galerkin_are_nodes_near_start(const galerkin_field *field, const tvi_step_origin *origin);

/* Makes the next pass, which moves the unknowns by *movement, and measures its roundoff: the difference from a pass
 * with displaced unknowns and displaced values of the field. Both results are sums of squares, as the passes measure
 * movements. */
TVI_NODISCARD tvi_status tvi_galerkin_measure_roundoff(galerkin_field *field, galerkin_roundoff_probe *probe,
                                                       double *movement, double *roundoff, tvi_stats *stats);

#endif
