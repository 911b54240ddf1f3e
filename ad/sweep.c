/* sweep.c - Runs a tape. Each kind of sweep walks through the runs once and calls the operation's rule. */
#include "sums.h"

static const double *slot(const double *x, int index, int lanes) { return x + (size_t)index * (size_t)lanes; }
static double *slot_of(double *x, int index, int lanes) { return x + (size_t)index * (size_t)lanes; }

static bool is_product(const jet_run *run) { return run->op == OP_PRODUCTS || run->op == OP_SQUARES; }

static bool values_together(const jet_run *run, double *x, int lanes)
{
    if (run->op == OP_POW) return jet_inverse_roots(run, run->together, x, lanes);
    jet_sine_cosine(run, run + 1, x, lanes);
    return true;
}

JET_INLINE bool values_of(const jet_tape *tape, double *x, int lanes)
{
    bool inside = true;
    for (const jet_run *run = tape->run, *const end = run + tape->runs; run < end; run++) {
        if (is_product(run)) jet_product_values(tape, run, x, lanes);
        else if (run->op == OP_LINEAR) jet_linear_values(tape, run, x, lanes);
        else if (run->together > 1) {
            inside &= values_together(run, x, lanes);
            run += run->together - 1;
        } else
            inside &= jet_rules[run->op]->value(run->c, run->count * lanes, slot(x, run->a, lanes),
                                                slot(x, run->b, lanes), slot_of(x, run->z, lanes));
    }
    return inside;
}

/* Makes the usual numbers of lanes constants for the compiler. */
static bool values(const jet_tape *tape, double *x, int lanes)
{
    return lanes == 1 ? values_of(tape, x, 1) : lanes == 8 ? values_of(tape, x, 8) : values_of(tape, x, lanes);
}

JET_INLINE bool series_of(const jet_tape *tape, double *x, int k, int lanes)
{
    if (k == 0) return values(tape, x, lanes);
    const size_t stride = (size_t)tape->slots;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) {
        if (is_product(run)) jet_product_series(tape, run, x, k, lanes);
        else if (run->op == OP_LINEAR) jet_linear_order(tape, run, x + (size_t)k * stride * (size_t)lanes, lanes);
        else jet_rules[run->op]->series(run, x, k, stride, lanes);
    }
    return true;
}

static bool series(const jet_tape *tape, double *x, int k, int lanes)
{
    return lanes == 1 ? series_of(tape, x, k, 1) : series_of(tape, x, k, lanes);
}

static void tangents(const jet_tape *tape, const double *x, double *dx, int k, int lanes)
{
    const size_t stride = (size_t)tape->slots;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) {
        if (is_product(run)) jet_product_tangent(tape, run, x, dx, k, 1, lanes);
        else if (run->op == OP_LINEAR) jet_linear_order(tape, run, dx + (size_t)k * stride * (size_t)lanes, lanes);
        else jet_rules[run->op]->tangent(run, x, dx, k, stride, lanes);
    }
}

static void tangents_in_lanes(const jet_tape *tape, const double *x, double *dx, int k, int lanes)
{
    const size_t stride = (size_t)tape->slots * (size_t)lanes;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) {
        if (is_product(run)) jet_product_tangent(tape, run, x, dx, k, lanes, lanes);
        else if (run->op == OP_LINEAR) jet_linear_order(tape, run, dx + (size_t)k * stride, lanes);
        else {
            const jet_run all = jet_flatten_lanes(run, lanes);
            jet_rules[run->op]->tangent(&all, x, dx, k, stride, 1);
        }
    }
}

static void adjoints(const jet_tape *tape, const double *x, double *bar, int k, int top)
{
    const size_t stride = (size_t)tape->slots;
    for (const jet_run *run = tape->run + tape->runs; run-- > tape->run;) {
        if (is_product(run)) jet_product_adjoint(tape, run, x, bar, k, top);
        else if (run->op == OP_LINEAR) jet_linear_adjoint(tape, run, bar + (size_t)k * stride);
        else jet_rules[run->op]->adjoint(run, x, bar, k, top, stride);
    }
}

static void combine(int count, const double *c, size_t of_c, int width, const double *table, double *out)
{
    jet_combine(count, c, of_c, width, table, out);
}

const jet_sweeps JET_FOR_ISA(jet_sweeps) = {JET_FOR_ISA(jet_isa), values,   series, tangents,
                                            tangents_in_lanes,    adjoints, combine};
