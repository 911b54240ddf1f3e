/* probe.c - Defines when the iteration that solves the equations of a Galerkin step may end (algebra/passes.h), and
 * measures its roundoff: how far one iteration, a pass, moves the unknowns by roundoff alone, so that further passes
 * bring nothing. For example, in a small motion about a position of size 1 the force has absolute errors of the
 * roundoff of that position, which exceed the roundoff of the small momenta. */
#include "galerkin/galerkin.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* [1] Passes without second derivatives end when the next pass is expected to move the unknowns by at most this part of
 * their sizes. This is far below roundoff, since what is left has the same sign in each step. */
#define GALERKIN_GOAL 0x1p-80 /* found: make longrun */
/* [1] A movement of the unknowns by at most this part may be roundoff, and shows no contraction. */
#define GALERKIN_ROUNDOFF_LEVEL (32 * DBL_EPSILON) /* found: make longrun */
/* [passes] A step begins again without prediction after this many passes, and fails after this many further ones. */
#define GALERKIN_MAX_PASSES 100 /* found: make stability */
/* [eps] The roundoff of a pass is measured by a pass from displaced unknowns and displaced values of the field. The
 * displacements have this many units of roundoff. */
#define GALERKIN_PROBE_UNITS 16 /* found: make stability */

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

/* Makes the rule for the form of the equations: whether passes are those of Newton's method decides how a correction is
 * compared with those before it. Without the term h g'' of the second derivatives of a Hamiltonian K = g h
 * (hamiltonian_pass.h) they are not: each pass reduces the error by a constant factor only. */
tvi_stopping_rule tvi_galerkin_make_stopping_rule(const galerkin_work *work)
{
    const galerkin_step *step = &work->step;
    const tvi_options *options = work->options;
    const double numbers = step->nodes.unknown_count * step->nodes.lane_count,
                 goal = step->form == GALERKIN_PLAIN ? GALERKIN_GOAL : GALERKIN_HESSIAN_GOAL;
    const tvi_stopping_rule rule = {.max_passes = GALERKIN_MAX_PASSES,
                                    .correction_goal = numbers * SQUARE(goal),
                                    .roundoff_level = numbers * SQUARE(GALERKIN_ROUNDOFF_LEVEL),
                                    .max_trusted_ratio = SQUARE(PASSES_MAX_CONTRACTION),
                                    .stall_ratio = TVI_STALL_WITHOUT_DECREASE,
                                    .stall_comparison_lag = 2,
                                    .is_convergence_quadratic =
                                        step->form == GALERKIN_HAMILTONIAN && step->system->hessian.is_complete};
    tvi_stopping_rule asked = tvi_passes_rule_with_options(&rule, options, SQUARE(options->tolerance));
    if (options->passes == TVI_PREDICT_ONLY) asked.max_passes = 0;
    return asked;
}

/* ---- Roundoff ---------------------------------------------------------------------------------------------------- */

static size_t bytes_of_rows(const galerkin_step *step, int rows)
{
    return (size_t)rows * (size_t)step->nodes.lane_count * sizeof(double);
}

void tvi_galerkin_allocate_probe(galerkin_work *work, tvi_arena *arena)
{
    galerkin_probe *probe = &work->probe;
    const size_t rows = bytes_of_rows(&work->step, probe->row_count),
                 unknowns = bytes_of_rows(&work->step, work->step.nodes.unknown_count);
    tvi_roundoff_allocate(&probe->roundoff, arena, work->step.system);
    probe->before = tvi_arena_allocate(arena, rows);
    probe->displaced = tvi_arena_allocate(arena, rows);
    probe->saved_free_motion_low = tvi_arena_allocate(arena, unknowns);
    probe->saved_impulse = tvi_arena_allocate(arena, unknowns);
}

void tvi_galerkin_add_roundoff(const galerkin_field_at_nodes *field, bool with_hessian)
{
    tvi_roundoff_estimator *roundoff = field->added_roundoff;
    const jet_tape *tape = field->tape[with_hessian];
    double *block = field->block[with_hessian];
    const int lanes = field->lane_count;
    for (int i = 0; i < roundoff->output_count; i++)
        for (int lane = 0; lane < lanes; lane++)
            block[tape->output_slot[i] * lanes + lane] +=
                tvi_roundoff_sign_randomly(roundoff, roundoff->output_roundoff[i]);
}

/* Displaces the unknowns, and the drift from which passes compute them, by GALERKIN_PROBE_UNITS units of roundoff. The
 * signs are the bits of a pseudorandom sequence. */
static void displace_unknowns(const galerkin_nodes *nodes)
{
    uint64_t bits = UINT64_C(0x9e3779b97f4a7c15);
    const int lanes = nodes->lane_count;
    for (int u = 0; u < nodes->unknown_count; u++)
        for (int k = u * lanes; k < (u + 1) * lanes && u % nodes->n < nodes->moving_count; k++) {
            const double size =
                GALERKIN_PROBE_UNITS * DBL_EPSILON * (fabs(nodes->start[u]) + fabs(nodes->x[k] - nodes->start[u]));
            bits = bits * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            nodes->x[k] += bits >> 63 ? size : -size;
            nodes->free_motion_low[k] += bits >> 63 ? size : -size;
        }
}

/* Returns the sum of the squares of the relative differences between x and the unknowns. */
static double squared_distance(const galerkin_nodes *nodes, const double *x)
{
    double sum = 0;
    for (int u = 0; u < nodes->unknown_count; u++)
        for (int k = u * nodes->lane_count; k < (u + 1) * nodes->lane_count; k++) {
            const double part = (nodes->x[k] - x[k]) * nodes->inverse_size[u];
            sum += part * part;
        }
    return sum;
}

/* Makes a pass from displaced unknowns, stores its result in the probe, and restores the nodes. */
static tvi_status make_displaced_pass(galerkin_step *step, double *movement, galerkin_counts *counts)
{
    const galerkin_nodes *nodes = &step->nodes;
    galerkin_probe *probe = step->probe;
    const size_t rows = bytes_of_rows(step, probe->row_count), unknowns = bytes_of_rows(step, nodes->unknown_count);
    memcpy(probe->saved_free_motion_low, nodes->free_motion_low, unknowns);
    memcpy(probe->saved_impulse, nodes->impulse, unknowns);
    displace_unknowns(nodes);
    step->field.added_roundoff = &probe->roundoff;
    const tvi_status status = tvi_galerkin_make_pass(step, movement, counts);
    step->field.added_roundoff = NULL;
    memcpy(probe->displaced, nodes->x, rows);
    memcpy(nodes->x, probe->before, rows);
    memcpy(nodes->free_motion_low, probe->saved_free_motion_low, unknowns);
    memcpy(nodes->impulse, probe->saved_impulse, unknowns);
    return status;
}

/* Makes the next pass, and measures its roundoff: the distance from where a pass with displaced unknowns and a
 * displaced field ends. The iterations within a pass may move the unknowns back and forth, so that only the distance
 * from their old to their new values counts. Both results are sums of squares, as movements are. */
static tvi_status measure_roundoff(galerkin_step *step, double *movement, double *roundoff, galerkin_counts *counts)
{
    const galerkin_nodes *nodes = &step->nodes;
    galerkin_probe *probe = step->probe;
    memcpy(probe->before, nodes->x, bytes_of_rows(step, probe->row_count));
    counts->evaluations += tvi_roundoff_estimate_field(&probe->roundoff, step->system, step->field.block[false],
                                                       nodes->lane_count, nodes->node_count);
    for (int i = 0; i < probe->roundoff.output_count; i++) probe->roundoff.output_roundoff[i] *= GALERKIN_PROBE_UNITS;
    tvi_status status = make_displaced_pass(step, movement, counts);
    if (status == TVI_OK) status = tvi_galerkin_make_pass(step, movement, counts);
    *roundoff = squared_distance(nodes, probe->displaced);
    *movement = squared_distance(nodes, probe->before);
    return status;
}

tvi_status tvi_galerkin_make_probed_pass(galerkin_step *step, const tvi_step_origin *origin, double *movement,
                                         double *roundoff, galerkin_counts *counts)
{
    const galerkin_nodes *nodes = &step->nodes;
    const double *second = nodes->x + nodes->n * nodes->lane_count;
    const bool is_roundoff = *movement <= step->rule.roundoff_level ||
                             tvi_roundoff_may_exceed_motion(step->system, step->h, origin->q, origin->p, nodes->x,
                                                            second, nodes->lane_count, nodes->node_count);
    return is_roundoff ? measure_roundoff(step, movement, roundoff, counts)
                       : tvi_galerkin_make_pass(step, movement, counts);
}
