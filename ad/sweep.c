/* sweep.c - runs a tape. Each kind of sweep walks the runs once and calls the operation's rule. */
#include "convolve.h"
#include "rule.h"
#include "tape.h"

#include <string.h>

void jet_tape_prepare(const jet_tape *tape, double *x, int orders, int lanes)
{
    memset(x, 0, (size_t)orders * (size_t)tape->slots * (size_t)lanes * sizeof *x);
    for (int i = 0; i < tape->constants; i++)
        for (int lane = 0; lane < lanes; lane++) x[(tape->inputs + i) * lanes + lane] = tape->constant[i];
}

/* z = sum_i coefficient_i x_i, at one order of a block: the same for values, series and tangents. */
#define LINEAR_BLOCK(type)                                                                                             \
    do {                                                                                                               \
        type sum = tape->term_coefficient[begin] * *(const type *)(x + (size_t)tape->term_slot[begin] * width + w);    \
        for (int term = begin + 1; term < end; term++)                                                                 \
            sum += tape->term_coefficient[term] * *(const type *)(x + (size_t)tape->term_slot[term] * width + w);      \
        *(type *)(z + w) = sum;                                                                                        \
    } while (0)

static void linear_sums(const jet_tape *tape, const jet_run *run, double *x, int lanes)
{
    const size_t width = (size_t)lanes;
    for (int i = 0; i < run->count; i++) {
        const int begin = tape->row[run->first + i], end = tape->row[run->first + i + 1];
        double *z = x + (size_t)(run->z + i) * width;
        int w = 0;
        for (; w + JET_WIDTH <= lanes; w += JET_WIDTH) LINEAR_BLOCK(jet_vector);
        for (; w < lanes; w++) LINEAR_BLOCK(double);
    }
}

/* The numbers that the sums add: to order 0 only. */
static void linear_numbers(const jet_tape *tape, const jet_run *run, double *x, int lanes)
{
    for (int i = 0; i < run->count; i++)
        for (int w = 0; w < lanes; w++) x[(run->z + i) * lanes + w] += tape->base[run->first + i];
}

bool jet_sweep_values(const jet_tape *tape, double *x, int lanes)
{
    bool inside = true;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) {
        if (run->op == OP_LINEAR) {
            linear_sums(tape, run, x, lanes);
            linear_numbers(tape, run, x, lanes);
            continue;
        }
        inside &= jet_rules[run->op].value(run->c, run->count * lanes, x + (size_t)run->a * (size_t)lanes,
                                           x + (size_t)run->b * (size_t)lanes, x + (size_t)run->z * (size_t)lanes);
    }
    return inside;
}

bool jet_sweep_series(const jet_tape *tape, double *x, int k, int lanes)
{
    if (k == 0) return jet_sweep_values(tape, x, lanes);
    const size_t stride = (size_t)tape->slots * (size_t)lanes;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) {
        if (run->op == OP_LINEAR) linear_sums(tape, run, x + (size_t)k * stride, lanes);
        else
            jet_rules[run->op].series(run->c, k, stride, run->count * lanes, x + (size_t)run->a * (size_t)lanes,
                                      x + (size_t)run->b * (size_t)lanes, x + (size_t)run->z * (size_t)lanes);
    }
    return true;
}

void jet_sweep_tangents(const jet_tape *tape, const double *x, double *dx, int k, int lanes)
{
    const size_t stride = (size_t)tape->slots, dstride = stride * (size_t)lanes;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) {
        if (run->op == OP_LINEAR) {
            linear_sums(tape, run, dx + (size_t)k * dstride, lanes);
            continue;
        }
        for (int i = 0; i < run->count; i++) {
            const size_t a = (size_t)(run->a + i), b = (size_t)(run->b + i), z = (size_t)(run->z + i);
            const jet_tangent member = {
                .c = run->c,
                .stride = stride,
                .dstride = dstride,
                .lanes = lanes,
                .a = x + a,
                .b = x + b,
                .z = x + z,
                .da = dx + a * (size_t)lanes,
                .db = dx + b * (size_t)lanes,
                .dz = dx + z * (size_t)lanes,
            };
            jet_rules[run->op].tangent(&member, k);
        }
    }
}
