/* record.c - Implements record.h. */
#include "record.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

double *numbers(size_t count)
{
    double *x = calloc(count, sizeof *x);
    ck_assert_ptr_nonnull(x);
    return x;
}

/* ---- Recording --------------------------------------------------------------------------------------------------- */

recording record_close(jet_graph *graph, int outputs, jet output[], jet_tape_kind kind)
{
    recording r = {.graph = graph, .inputs = jet_graph_input_count(graph), .outputs = outputs};
    ck_assert_int_eq(jet_graph_check_outputs(graph, outputs, output), TVI_OK);
    jet_graph_end_recording(graph);
    r.tape = jet_tape_create(graph, r.inputs, outputs, output, kind);
    ck_assert_ptr_nonnull(r.tape);
    return r;
}

void recording_free(recording *r)
{
    jet_tape_free(r->tape);
    jet_graph_free(r->graph);
}

/* A new open graph with f recorded in it. */
static jet_graph *record_open(const function *f, jet z[])
{
    jet_graph *graph = jet_graph_create(f->inputs);
    ck_assert_ptr_nonnull(graph);
    jet x[INPUTS_MAX];
    for (int i = 0; i < f->inputs; i++) x[i] = jet_graph_input(graph, i);
    f->record(f->c, x, z);
    return graph;
}

recording record_outputs(const function *f, jet_tape_kind kind)
{
    jet z[OUTPUTS_MAX];
    jet_graph *graph = record_open(f, z);
    return record_close(graph, f->outputs, z, kind);
}

recording record_gradient(const function *f, int output, jet_tape_kind kind)
{
    jet z[OUTPUTS_MAX], gradient[INPUTS_MAX];
    jet_graph *graph = record_open(f, z);
    ck_assert(jet_record_gradient(graph, z[output], f->inputs, gradient));
    return record_close(graph, f->inputs, gradient, kind);
}

recording record_second_gradient(const function *f, int output, int i, jet_tape_kind kind)
{
    jet z[OUTPUTS_MAX], gradient[INPUTS_MAX], second[INPUTS_MAX];
    jet_graph *graph = record_open(f, z);
    ck_assert(jet_record_gradient(graph, z[output], f->inputs, gradient));
    ck_assert(jet_record_gradient(graph, gradient[i], f->inputs, second));
    return record_close(graph, f->inputs, second, kind);
}

recording record_lift(const function *f, bool of_gradient, jet_tape_kind kind)
{
    jet z[OUTPUTS_MAX + INPUTS_MAX], x[INPUTS_MAX], dx[INPUTS_MAX], lifted[2 * (OUTPUTS_MAX + INPUTS_MAX)];
    jet_graph *from = record_open(f, z), *graph = jet_graph_create(2 * f->inputs);
    const int outputs = of_gradient ? f->inputs : f->outputs;
    if (of_gradient) ck_assert(jet_record_gradient(from, z[f->outputs - 1], f->inputs, z));
    ck_assert_int_eq(jet_graph_check_outputs(from, outputs, z), TVI_OK);
    jet_graph_end_recording(from);
    const int nodes = jet_graph_node_count(from);
    for (int i = 0; i < f->inputs; i++) {
        x[i] = jet_graph_input(graph, f->inputs - 1 - i);
        dx[i] = jet_graph_input(graph, 2 * f->inputs - 1 - i);
    }
    ck_assert(jet_record_forward_derivatives(from, graph, x, dx, NULL, outputs, z, lifted, lifted + outputs));
    ck_assert_int_eq(jet_graph_node_count(from), nodes);
    jet_graph_free(from); /* nothing is left of it in the lift */
    return record_close(graph, 2 * outputs, lifted, kind);
}

/* ---- Running ----------------------------------------------------------------------------------------------------- */

/* Copies orders first..last of the inputs into a block. */
static void set_inputs(const recording *r, int degree, int lanes, int first, int last, const double x[], double *block)
{
    for (int k = first; k <= last; k++)
        for (int i = 0; i < r->inputs; i++)
            memcpy(block + (k * r->tape->slot_count + i) * lanes, x + (i * (degree + 1) + k) * lanes,
                   (size_t)lanes * sizeof *x);
}

static void get_outputs(const recording *r, int degree, int lanes, const double *block, double z[])
{
    for (int k = 0; k <= degree; k++)
        for (int i = 0; i < r->outputs; i++)
            memcpy(z + (i * (degree + 1) + k) * lanes,
                   block + (k * r->tape->slot_count + r->tape->output_slot[i]) * lanes, (size_t)lanes * sizeof *z);
}

/* NaN into the slots that sweeps compute, or into the inputs as well. */
static void spoil(const jet_tape *tape, int orders, int lanes, bool inputs_too, double *block)
{
    for (int k = 0; k < orders; k++)
        for (int slot = 0; slot < tape->slot_count; slot++) {
            const bool is_input = slot < tape->input_count,
                       is_constant = !is_input && slot < tape->input_count + tape->constant_count;
            if (is_constant || (is_input && !inputs_too)) continue;
            for (int lane = 0; lane < lanes; lane++) block[(k * tape->slot_count + slot) * lanes + lane] = NAN;
        }
}

static double *new_block(const jet_tape *tape, int orders, int lanes)
{
    return numbers((size_t)orders * (size_t)tape->slot_count * (size_t)lanes);
}

bool run_values(const recording *r, int lanes, const double x[], double z[])
{
    double *block = new_block(r->tape, 1, lanes);
    jet_tape_write_constants(r->tape, block, 1, lanes);
    spoil(r->tape, 1, lanes, false, block);
    set_inputs(r, 0, lanes, 0, 0, x, block);
    const bool inside = jet_sweep_values(r->tape, block, lanes);
    get_outputs(r, 0, lanes, block, z);
    free(block);
    return inside;
}

static double size_of(const jet_tape *tape, int slot, int lanes, const double *lane)
{
    double size = fabs(lane[slot * lanes]);
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++)
        for (int k = 0;
             run->op == OP_LINEAR && slot >= run->z && slot < run->z + run->operation_count && k < run->term_count;
             k++) {
            const int term = run->first_term_index + (slot - run->z) * run->term_count + k;
            size += fabs(tape->terms.coefficient[term] * lane[tape->terms.slot[term] * lanes]);
        }
    return size;
}

void run_sizes(const recording *r, int lanes, const double x[], double size[])
{
    double *block = new_block(r->tape, 1, lanes);
    jet_tape_write_constants(r->tape, block, 1, lanes);
    set_inputs(r, 0, lanes, 0, 0, x, block);
    (void)jet_sweep_values(r->tape, block, lanes);
    for (int i = 0; i < r->outputs * lanes; i++)
        size[i] = size_of(r->tape, r->tape->output_slot[i / lanes], lanes, block + i % lanes);
    free(block);
}

bool run_series(const recording *r, int degree, int lanes, const double x[], double z[])
{
    double *block = new_block(r->tape, degree + 1, lanes);
    jet_tape_write_constants(r->tape, block, degree + 1, lanes);
    spoil(r->tape, degree + 1, lanes, true, block);
    bool inside = true;
    for (int k = 0; k <= degree; k++) {
        set_inputs(r, degree, lanes, k, k, x, block);
        inside &= jet_sweep_series(r->tape, block, k, lanes);
    }
    get_outputs(r, degree, lanes, block, z);
    free(block);
    return inside;
}

void run_tangents(const recording *r, int degree, int lanes_of_x, int lanes, const double x[], const double dx[],
                  double dz[])
{
    double *block = new_block(r->tape, degree + 1, lanes_of_x), *dblock = new_block(r->tape, degree + 1, lanes);
    jet_tape_write_constants(r->tape, block, degree + 1, lanes_of_x);
    spoil(r->tape, degree + 1, lanes_of_x, true, block);
    spoil(r->tape, degree + 1, lanes, true, dblock);
    for (int k = 0; k <= degree; k++) {
        set_inputs(r, degree, lanes_of_x, k, k, x, block);
        ck_assert(jet_sweep_series(r->tape, block, k, lanes_of_x));
        set_inputs(r, degree, lanes, k, k, dx, dblock);
        if (lanes_of_x == 1) jet_sweep_tangents(r->tape, block, dblock, k, lanes);
        else jet_sweep_one_tangent_per_lane(r->tape, block, dblock, k, lanes);
    }
    get_outputs(r, degree, lanes, dblock, dz);
    free(block);
    free(dblock);
}

void run_adjoints(const recording *r, int degree, const double x[], const double zbar[], double xbar[])
{
    const jet_tape *tape = r->tape;
    double *block = new_block(tape, degree + 1, 1), *bar = new_block(tape, degree + 1, 1);
    jet_tape_write_constants(tape, block, degree + 1, 1);
    for (int k = 0; k <= degree; k++) {
        set_inputs(r, degree, 1, k, k, x, block);
        ck_assert(jet_sweep_series(tape, block, k, 1));
        for (int i = 0; i < r->outputs; i++)
            bar[k * tape->slot_count + tape->output_slot[i]] += zbar[i * (degree + 1) + k];
    }
    for (int k = degree; k >= 0; k--) jet_sweep_adjoints(tape, block, bar, k, degree);
    for (int i = 0; i < r->inputs; i++)
        for (int k = 0; k <= degree; k++) xbar[i * (degree + 1) + k] = bar[k * tape->slot_count + i];
    free(block);
    free(bar);
}

void get_lane(int count, int degree, int lanes, int lane, const double all[], double one[])
{
    for (int i = 0; i < count * (degree + 1); i++) one[i] = all[i * lanes + lane];
}

void set_lane(int count, int degree, int lanes, int lane, const double one[], double all[])
{
    for (int i = 0; i < count * (degree + 1); i++) all[i * lanes + lane] = one[i];
}

/* ---- Comparing --------------------------------------------------------------------------------------------------- */

double natural_scale(int degree, const double z[], int k)
{
    double scale = fabs(z[k]);
    for (int i = 1; i <= 2 && i <= k && k + i <= degree; i++) scale = fmax(scale, sqrt(fabs(z[k - i] * z[k + i])));
    if (k < degree || k < 2 || z[k - 2] == 0) return scale;
    return fmax(scale, fmin(fabs(z[k - 1]), z[k - 1] * z[k - 1] / fabs(z[k - 2])));
}

/* The error of coefficient k in units of its natural scale. */
static double coefficient_error(int degree, const double got[], const double want[], const double scale[], int k)
{
    const double error = fabs(got[k] - want[k]);
    if (!isfinite(error)) return INFINITY;
    return error == 0 ? 0 : error / natural_scale(degree, scale, k);
}

double series_error(int degree, const double got[], const double want[], const double scale[])
{
    double worst = 0;
    for (int k = 0; k <= degree; k++) worst = fmax(worst, coefficient_error(degree, got, want, scale, k));
    return worst;
}

void check_series(const char *what, int degree, const double got[], const double want[], double bound)
{
    for (int k = 0; k <= degree; k++) {
        const double error = coefficient_error(degree, got, want, want, k);
        ck_assert_msg(error <= bound, "%s, order %d: %.17g instead of %.17g, relative error %.2g > %.2g", what, k,
                      got[k], want[k], error, bound);
    }
}

int operations_of(const jet_tape *tape, jet_op op)
{
    int count = 0;
    for (int i = 0; i < tape->run_count; i++) count += tape->runs[i].op == op ? tape->runs[i].operation_count : 0;
    return count;
}
