/* roundoff.c - Estimates the roundoff in the values of a field, by tangents in random directions (roundoff.h). */
#include "system/roundoff.h"
#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* [1] The motion in a step is small if no node is farther from q at the start than |q| plus this many times the
 * drift. */
#define ROUNDOFF_MAX_SPEED_GROWTH 4 /* found: make check-generating, suite convergence */

enum { SAMPLES = TVI_ROUNDOFF_SAMPLES };

void tvi_roundoff_allocate(tvi_roundoff_estimator *roundoff, tvi_arena *arena, const tvi_system *system)
{
    const size_t slots = (size_t)system->field_series->slot_count;
    roundoff->output_count = tvi_system_output_count(system);
    roundoff->output_roundoff = tvi_arena_allocate_doubles(arena, (size_t)roundoff->output_count);
    roundoff->field_block = tvi_arena_allocate_block(arena, system->field_series, 1, 1, 0);
    roundoff->propagated_roundoff_of_slots = tvi_arena_allocate_doubles(arena, slots * SAMPLES);
}

double tvi_roundoff_sign_randomly(tvi_roundoff_estimator *roundoff, double size)
{
    roundoff->random_state = roundoff->random_state * 1664525u + 1013904223u;
    return roundoff->random_state >> 31 ? -size : size;
}

/* Tells whether an operation of a run only multiplies by a power of two, which is exact. */
static bool is_multiplication_exact(const jet_tape *tape, const jet_run_of_operations *run, int operation)
{
    int exponent;
    return run->op == OP_LINEAR && run->term_count == 1 &&
           tape->constant_terms[run->first_constant_term_index + operation] == 0 &&
           fabs(frexp(tape->terms.coefficient[run->first_term_index + operation], &exponent)) == 0.5;
}

/* Returns the magnitude to which the roundoff of an operation of a run is relative: the magnitude of its result, or
 * for a sum that of its terms. */
static double compute_roundoff_scale(const jet_tape *tape, const jet_run_of_operations *run, int operation,
                                     const double *x)
{
    const bool is_linear = run->op == OP_LINEAR, is_products = run->op == OP_PRODUCTS;
    if (!is_linear && !is_products && run->op != OP_SQUARES) return fabs(x[run->z + operation]);
    if (is_multiplication_exact(tape, run, operation)) return 0;
    double sum = is_linear ? fabs(tape->constant_terms[run->first_constant_term_index + operation]) : 0;
    for (int term = 0; term < run->term_count; term++) {
        const int k = run->first_term_index + term + (is_linear ? operation * run->term_count : 0),
                  at = is_linear ? 0 : operation;
        const double a = x[tape->terms.slot[k] + at];
        const double b = is_linear ? 1 : is_products ? x[tape->terms.slot_b[k] + at] : a;
        sum += fabs(tape->terms.coefficient[k] * a * b);
    }
    return sum;
}

/* Adds DBL_EPSILON times roundoff_scale to the tangents of a slot, with a sign for each sample. The signs are bits of a
 * hash of the value's digits. Therefore they depend neither on units nor on the order of slots, and equal values have
 * equal errors. */
static void add_slot_roundoff(const double *slot_values, double *slot_tangents, int slot, double roundoff_scale)
{
    int exponent;
    const double digits = frexp(fabs(slot_values[slot]), &exponent);
    const uint64_t bits = jet_continue_hash(JET_HASH_OF_NOTHING, &digits, sizeof digits);
    for (int s = 0; s < SAMPLES && roundoff_scale > 0; s++)
        slot_tangents[slot * SAMPLES + s] +=
            bits >> (63 - s) & 1 ? DBL_EPSILON * roundoff_scale : -DBL_EPSILON * roundoff_scale;
}

void tvi_roundoff_sweep_tape(const jet_tape *tape, int input_count, const double input_sizes[], const double *x,
                             double *dx)
{
    memset(dx, 0, (size_t)input_count * SAMPLES * sizeof *dx);
    for (int i = 0; i < input_count; i++) add_slot_roundoff(x, dx, i, input_sizes ? input_sizes[i] : fabs(x[i]));
    for (int r = 0; r < tape->run_count; r++) {
        jet_tape one_run = *tape;
        /* The interpreter sweeps the single run of this tape, since generated code sweeps only whole tapes. */
        one_run.sweeps = tape->interpreter_sweeps;
        one_run.runs = tape->runs + r;
        one_run.run_count = 1;
        jet_sweep_tangents(&one_run, x, dx, 0, SAMPLES);
        for (int i = 0; i < one_run.runs->operation_count; i++)
            add_slot_roundoff(x, dx, one_run.runs->z + i, compute_roundoff_scale(tape, one_run.runs, i, x));
    }
}

int tvi_roundoff_estimate_field(tvi_roundoff_estimator *roundoff, const tvi_system *system, const double *inputs,
                                int lanes, int point_count)
{
    const jet_tape *tape = system->field_series;
    const int outputs = roundoff->output_count;
    roundoff->random_state = 1;
    memset(roundoff->output_roundoff, 0, (size_t)outputs * sizeof *roundoff->output_roundoff);
    for (int point = 0; point < point_count; point++) {
        for (int i = 0; i < system->input_count + system->uses_time; i++)
            roundoff->field_block[i] = inputs[i * lanes + point];
        if (!jet_sweep_values(tape, roundoff->field_block, 1)) continue;
        tvi_roundoff_sweep_tape(tape, system->input_count, NULL, roundoff->field_block,
                                roundoff->propagated_roundoff_of_slots);
        for (int i = 0; i < outputs; i++)
            roundoff->output_roundoff[i] =
                fmax(roundoff->output_roundoff[i],
                     tvi_largest_magnitude(SAMPLES,
                                           roundoff->propagated_roundoff_of_slots + tape->output_slot[i] * SAMPLES, 1));
    }
    return point_count * (1 + SAMPLES);
}

/* Tells whether the vectors of n components at all points, which are columns of rows [n][lanes], differ from start [n]
 * by at most this distance in each component. */
static bool are_close_to_start(int n, double distance, const double start[], const double *rows, int lanes,
                               int point_count)
{
    for (int i = 0; i < n; i++)
        for (int point = 0; point < point_count; point++)
            if (!(fabs(rows[i * lanes + point] - start[i]) <= distance)) return false;
    return true;
}

bool tvi_roundoff_may_exceed_motion(const tvi_system *system, double h, const double q_start[], const double p_start[],
                                    const double *q_at_nodes, const double *p_at_nodes, int lanes, int node_count)
{
    const int n = system->n;
    const bool separable = system->form == TVI_SEPARABLE;
    double distance = 0;
    if (separable)
        for (int i = 0; i < n; i++) distance = fmax(distance, fabs(h * p_start[i] / system->mass[i]));
    return are_close_to_start(n, tvi_largest_magnitude(n, q_start, 1) + ROUNDOFF_MAX_SPEED_GROWTH * distance, q_start,
                              q_at_nodes, lanes, node_count) ||
           (!separable &&
            are_close_to_start(n, tvi_largest_magnitude(n, p_start, 1), p_start, p_at_nodes, lanes, node_count));
}
