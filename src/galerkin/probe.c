/* probe.c - Defines when the iteration that solves the equations of a Galerkin step may end (algebra/passes.h), and
 * measures its roundoff: how far one iteration, a pass, moves the unknowns by roundoff alone, so that further passes
 * bring nothing. For example, in a small motion about a position of size 1 the force has absolute errors of the
 * roundoff of that position, which exceed the roundoff of the small momenta. */
#include "galerkin/step.h"
#include "method/stepper.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* ---- The rules --------------------------------------------------------------------------------------------------- */

/* The rules that end the passes. Sizes of corrections are squares, summed over all unknowns and lanes, relative to the
 * sizes of the unknowns. The numbers here are for a single unknown at one node.
 *
 * correction_goal: the error that a step leaves has the same sign in each step and grows as the number of steps, but
 * roundoff grows as its square root. A goal of 2^-80 keeps this error below the roundoff for more than 10^9 steps.
 * (A drift that no goal changes is left by where passes come to rest: docs/roundoff.md.)
 * Passes of Newton's method cost more. Their goal of 2^-72 does so for fewer steps, by a factor of 2^16.
 * roundoff_level: corrections below it do not show how fast the passes contract. The corrections of a small step are
 * soon below it; its passes are assumed to contract as those of an earlier step.
 * stall_comparison_lag: in the equations of a Hamiltonian, passes may alternately contract much and little. */
#define SQUARE(x) ((x) * (x))
#define RULE(GOAL)                                                                                                     \
    .max_passes = GALERKIN_MAX_PASSES, .correction_goal = SQUARE(GOAL),                                                \
    .roundoff_level = SQUARE(GALERKIN_ROUNDOFF_LEVEL),                                                                 \
    .max_trusted_contraction_ratio = SQUARE(PASSES_MAX_CONTRACTION),                                                   \
    .stall_contraction_ratio = TVI_STALL_WITHOUT_DECREASE, .stall_comparison_lag = 2
const tvi_stopping_rule tvi_galerkin_fixed_point = {RULE(GALERKIN_GOAL)};
const tvi_stopping_rule tvi_galerkin_quasi_newton = {RULE(GALERKIN_HESSIAN_GOAL)};
const tvi_stopping_rule tvi_galerkin_newton = {RULE(GALERKIN_HESSIAN_GOAL), .is_convergence_quadratic = true};

tvi_stopping_rule tvi_galerkin_scale_passes_rule(const tvi_stopping_rule *rule_per_unknown, int unknown_value_count,
                                                 const tvi_options *options)
{
    tvi_stopping_rule rule = *rule_per_unknown;
    rule.correction_goal *= unknown_value_count;
    rule.roundoff_level *= unknown_value_count;
    rule = tvi_passes_rule_with_options(&rule, options, SQUARE(options->tolerance));
    if (options->passes == TVI_PREDICT_ONLY) rule.max_passes = 0;
    return rule;
}

/* ---- Roundoff ---------------------------------------------------------------------------------------------------- */

static size_t count_doubles_in_rows(const galerkin_equations *equations, int row_count)
{
    return (size_t)row_count * (size_t)equations->nodes.lane_count;
}

void tvi_galerkin_allocate_probe(galerkin_roundoff_probe *probe, tvi_arena *arena, const galerkin_equations *equations)
{
    tvi_roundoff_allocate(&probe->tape_output_roundoff, arena, equations->system);
    probe->values_before_pass = tvi_arena_allocate_doubles(
        arena, count_doubles_in_rows(equations, equations->node_value_row_count_read_by_pass));
    probe->values_after_displaced_pass = tvi_arena_allocate_doubles(
        arena, count_doubles_in_rows(equations, equations->node_value_row_count_read_by_pass));
    probe->saved_drift_values_low =
        tvi_arena_allocate_doubles(arena, count_doubles_in_rows(equations, equations->nodes.unknown_count));
    probe->saved_impulses =
        tvi_arena_allocate_doubles(arena, count_doubles_in_rows(equations, equations->nodes.unknown_count));
}

/* Displaces the unknowns, and the drift values from which passes compute them, by GALERKIN_PROBE_UNITS units of
 * roundoff. The signs are the bits of a pseudorandom sequence. */
static void displace_unknowns(galerkin_nodes *nodes)
{
    uint64_t bits = UINT64_C(0x9e3779b97f4a7c15);
    for (int u = 0; u < nodes->unknown_count; u++)
        for (int k = u * nodes->lane_count;
             k < (u + 1) * nodes->lane_count && u % nodes->coordinate_unknown_count < nodes->moving_unknown_count;
             k++) {
            const double size = GALERKIN_PROBE_UNITS * DBL_EPSILON *
                                (fabs(nodes->start_values[u]) + fabs(nodes->values[k] - nodes->start_values[u]));
            bits = bits * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            nodes->values[k] += bits >> 63 ? size : -size;
            nodes->drift_values_low[k] += bits >> 63 ? size : -size;
        }
}

/* Returns the sum of the squares of the relative differences between x and the unknowns. */
static double compute_squared_distance_to_unknowns(const galerkin_nodes *nodes, const double *x)
{
    double sum = 0;
    for (int u = 0; u < nodes->unknown_count; u++)
        for (int k = u * nodes->lane_count; k < (u + 1) * nodes->lane_count; k++) {
            const double part = (nodes->values[k] - x[k]) * nodes->inverse_unknown_size[u];
            sum += part * part;
        }
    return sum;
}

/* Makes a pass from displaced unknowns, stores its result in the probe, and restores the nodes. */
static tvi_status make_pass_from_displaced_unknowns(galerkin_equations *equations, galerkin_roundoff_probe *probe,
                                                    double *movement, tvi_stats *stats)
{
    galerkin_nodes *nodes = &equations->nodes;
    const size_t bytes =
        count_doubles_in_rows(equations, equations->node_value_row_count_read_by_pass) * sizeof(double);
    const size_t base_bytes = count_doubles_in_rows(equations, nodes->unknown_count) * sizeof(double);
    memcpy(probe->saved_drift_values_low, nodes->drift_values_low, base_bytes);
    memcpy(probe->saved_impulses, nodes->impulses, base_bytes);
    displace_unknowns(nodes);
    equations->tape_output_roundoff_to_add = &probe->tape_output_roundoff;
    const tvi_status status = galerkin_make_pass(equations, movement, stats);
    equations->tape_output_roundoff_to_add = NULL;
    memcpy(probe->values_after_displaced_pass, nodes->values, bytes);
    memcpy(nodes->values, probe->values_before_pass, bytes);
    memcpy(nodes->drift_values_low, probe->saved_drift_values_low, base_bytes);
    memcpy(nodes->impulses, probe->saved_impulses, base_bytes);
    return status;
}

/* Measures the movement of a pass and its roundoff. The iterations within a pass may move the unknowns back and
 * forth, so that only the distance from their old to their new values counts. */
tvi_status tvi_galerkin_measure_roundoff(galerkin_equations *equations, galerkin_roundoff_probe *probe,
                                         double *movement, double *roundoff, tvi_stats *stats)
{
    const galerkin_nodes *nodes = &equations->nodes;
    memcpy(probe->values_before_pass, nodes->values,
           count_doubles_in_rows(equations, equations->node_value_row_count_read_by_pass) * sizeof(double));
    stats->force_evaluations +=
        tvi_roundoff_estimate_field(&probe->tape_output_roundoff, equations->system, equations->tape_block,
                                    nodes->lane_count, equations->node_count);
    for (int i = 0; i < tvi_system_output_count(equations->system); i++)
        probe->tape_output_roundoff.output_roundoff[i] *= GALERKIN_PROBE_UNITS;
    tvi_status status = make_pass_from_displaced_unknowns(equations, probe, movement, stats);
    if (status == TVI_OK) status = galerkin_make_pass(equations, movement, stats);
    *roundoff = compute_squared_distance_to_unknowns(nodes, probe->values_after_displaced_pass);
    *movement = compute_squared_distance_to_unknowns(nodes, probe->values_before_pass);
    return status;
}

bool tvi_galerkin_are_nodes_near_start(const galerkin_equations *equations, const tvi_step_origin *origin)
{
    const galerkin_nodes *nodes = &equations->nodes;
    return tvi_roundoff_may_exceed_step_motion(equations->system, equations->step_size, origin->q, origin->p,
                                               nodes->values, nodes->values + equations->system->n * nodes->lane_count,
                                               nodes->lane_count, equations->node_count);
}
