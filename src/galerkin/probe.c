/* probe.c - Defines when the passes of a Galerkin step may end (algebra/passes.h), and measures the roundoff of a pass,
 * which passes cannot go below. For a small motion about a position of size 1 that is more than the roundoff of its
 * momenta: they have no more digits than the force at this position. */
#include "galerkin/probe.h"
#include "method/passes_rule.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* ---- The rules --------------------------------------------------------------------------------------------------- */

/* The rules of the passes. Sizes are squares, summed over all unknowns and lanes, relative to the sizes of the
 * unknowns; here they are for a single one. The error that a step leaves has the same sign in the next step, but
 * roundoff changes its sign. The error stays below the roundoff of N steps if it is that of one step / sqrt(N), with
 * 2^-80 for more than 10^9 steps. A Newton method, whose passes cost more, allows 2^16 times fewer. Passes of a small
 * step soon do no more than roundoff, which does not show how far they contract: they are then assumed to contract as
 * those of an earlier step did. In the equations of a Hamiltonian the passes of Q may contract little and those of P
 * much, alternately. */
#define SQUARE(x) ((x) * (x))
#define RULE(GOAL)                                                                                                     \
    .max_passes = 100, .correction_goal = SQUARE(GOAL), .roundoff_level = SQUARE(32 * DBL_EPSILON),                    \
    .max_contraction = SQUARE(0.5), .stall_ratio = TVI_PASSES_ALL, .stall_period = 2
const tvi_passes_rule tvi_galerkin_fixed_point = {RULE(0x1p-80)};
const tvi_passes_rule tvi_galerkin_quasi_newton = {RULE(0x1p-72)};
const tvi_passes_rule tvi_galerkin_newton = {RULE(0x1p-72), .is_quadratic = true};

tvi_passes_rule tvi_galerkin_rule(const tvi_passes_rule *of_one, int numbers, const tvi_options *o)
{
    tvi_passes_rule rule = *of_one;
    rule.correction_goal *= numbers;
    rule.roundoff_level *= numbers;
    rule = tvi_passes_rule_with_options(&rule, o, SQUARE(o->tolerance));
    if (o->passes == TVI_PREDICT_ONLY) rule.max_passes = 0;
    return rule;
}

/* ---- Roundoff ---------------------------------------------------------------------------------------------------- */

/* A movement is roundoff if displacing the unknowns and the values of the field by this many units of roundoff moves
 * them as far. */
enum { UNITS = 16 };

static size_t numbers(const galerkin_field *field, int rows) { return (size_t)rows * (size_t)field->nodes.lanes; }

void tvi_galerkin_probe_take(galerkin_probe *probe, tvi_arena *arena, const galerkin_field *field)
{
    tvi_roundoff_allocate(&probe->of_field, arena, field->system);
    probe->before = tvi_arena_doubles(arena, numbers(field, field->rows));
    probe->displaced = tvi_arena_doubles(arena, numbers(field, field->rows));
    probe->base = tvi_arena_doubles(arena, numbers(field, field->nodes.unknowns));
    probe->impulse = tvi_arena_doubles(arena, numbers(field, field->nodes.unknowns));
}

/* Displaces the unknowns, and the values that passes bring them back to, by some units of the roundoff of a pass, up or
 * down by the bits of a sequence. */
static void displace(galerkin_nodes *nodes)
{
    uint64_t bits = UINT64_C(0x9e3779b97f4a7c15);
    for (int u = 0; u < nodes->unknowns; u++)
        for (int k = u * nodes->lanes; k < (u + 1) * nodes->lanes && u % nodes->half < nodes->moving; k++) {
            const double size = UNITS * DBL_EPSILON * (fabs(nodes->start[u]) + fabs(nodes->x[k] - nodes->start[u]));
            bits = bits * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            nodes->x[k] += bits >> 63 ? size : -size;
            nodes->base[k] += bits >> 63 ? size : -size;
        }
}

/* The square of the relative distance from x to the unknowns. */
static double distance(const galerkin_nodes *nodes, const double *x)
{
    double sum = 0;
    for (int u = 0; u < nodes->unknowns; u++)
        for (int k = u * nodes->lanes; k < (u + 1) * nodes->lanes; k++) {
            const double part = (nodes->x[k] - x[k]) * nodes->inverse_size[u];
            sum += part * part;
        }
    return sum;
}

/* Makes a pass from displaced unknowns, and restores everything. */
static tvi_status pass_displaced(galerkin_field *field, galerkin_probe *probe, double *moved, tvi_stats *stats)
{
    galerkin_nodes *nodes = &field->nodes;
    const size_t bytes = numbers(field, field->rows) * sizeof(double);
    const size_t base_bytes = numbers(field, nodes->unknowns) * sizeof(double);
    memcpy(probe->base, nodes->base, base_bytes);
    memcpy(probe->impulse, nodes->impulse, base_bytes);
    displace(nodes);
    field->noise = &probe->of_field;
    const tvi_status status = tvi_galerkin_pass(field, moved, stats);
    field->noise = NULL;
    memcpy(probe->displaced, nodes->x, bytes);
    memcpy(nodes->x, probe->before, bytes);
    memcpy(nodes->base, probe->base, base_bytes);
    memcpy(nodes->impulse, probe->impulse, base_bytes);
    return status;
}

/* Measures a pass and its roundoff. The rounds of a pass may move the unknowns back and forth, so that only the
 * distance from their old to their new values counts. */
tvi_status tvi_galerkin_measure(galerkin_field *field, galerkin_probe *probe, double *moved, double *roundoff,
                                tvi_stats *stats)
{
    const galerkin_nodes *nodes = &field->nodes;
    memcpy(probe->before, nodes->x, numbers(field, field->rows) * sizeof(double));
    stats->force_evaluations +=
        tvi_roundoff_estimate_of_field(&probe->of_field, field->system, field->inputs, nodes->lanes, field->points);
    for (int i = 0; i < tvi_system_output_count(field->system); i++) probe->of_field.change[i] *= UNITS;
    tvi_status status = pass_displaced(field, probe, moved, stats);
    if (status == TVI_OK) status = tvi_galerkin_pass(field, moved, stats);
    *roundoff = distance(nodes, probe->displaced);
    *moved = distance(nodes, probe->before);
    return status;
}

bool tvi_galerkin_is_near(const galerkin_field *field, const tvi_origin *origin)
{
    const galerkin_nodes *nodes = &field->nodes;
    return tvi_roundoff_is_motion_small(field->system, field->h, origin->q, origin->p, nodes->x,
                                        nodes->x + field->system->n * nodes->lanes, nodes->lanes, field->points);
}
