/* sweep.c - runs a tape. Each kind of sweep walks the runs once and calls the operation's rule. */
#include "rule.h"
#include "tape.h"

#include <string.h>

static const double *slot(const double *x, int index, int lanes) { return x + (size_t)index * (size_t)lanes; }
static double *slot_of(double *x, int index, int lanes) { return x + (size_t)index * (size_t)lanes; }

/* ---- z = number + sum_i coefficient_i x_i: the same for values, series and tangents, but for the number ---------- */

/* function(tape, run, x, terms), with the number of terms known to the compiler where it is small. */
#define BY_TERMS(function, tape, run, x)                                                                               \
    switch ((run)->terms) {                                                                                            \
    case 1: function(tape, run, x, 1); break;                                                                          \
    case 2: function(tape, run, x, 2); break;                                                                          \
    case 3: function(tape, run, x, 3); break;                                                                          \
    case 4: function(tape, run, x, 4); break;                                                                          \
    case 5: function(tape, run, x, 5); break;                                                                          \
    default: function(tape, run, x, (run)->terms);                                                                     \
    }

/* One lane. */
static inline __attribute__((always_inline)) void sums_of_one(const jet_tape *tape, const jet_run *run, double *x,
                                                              int terms)
{
    const int *from = tape->term_slot + run->term;
    const double *coefficient = tape->term_coefficient + run->term;
    double *z = x + run->z, *const end = z + run->count;
    for (; z < end; z++, from += terms, coefficient += terms) {
        double sum = coefficient[0] * x[from[0]];
        for (int term = 1; term < terms; term++) sum += coefficient[term] * x[from[term]];
        *z = sum;
    }
}

#define LINEAR(V, S)                                                                                                   \
    {                                                                                                                  \
        V sum = coefficient[0] * S(V, x, from[0]);                                                                     \
        for (int term = 1; term < terms; term++) sum += coefficient[term] * S(V, x, from[term]);                       \
        JET_AT(V, z, 0) = sum;                                                                                         \
    }

static void sums_of_many(const jet_tape *tape, const jet_run *run, double *x, int lanes)
{
    const size_t stride = (size_t)lanes;
    const int *from = tape->term_slot + run->term, terms = run->terms;
    const double *coefficient = tape->term_coefficient + run->term;
    for (int i = 0; i < run->count; i++, from += run->terms, coefficient += run->terms) {
        double *z = x + (size_t)(run->z + i) * stride;
        JET_BLOCKS(lanes, LINEAR, JET_OF);
    }
}

/* Eight lanes. */
static inline __attribute__((always_inline)) void sums_of_eight(const jet_tape *tape, const jet_run *run, double *x,
                                                                int terms)
{
    enum { stride = 8 };
    const int *from = tape->term_slot + run->term;
    const double *coefficient = tape->term_coefficient + run->term;
    double *z = x + stride * (size_t)run->z, *const end = z + stride * (size_t)run->count;
    for (; z < end; z += stride, from += terms, coefficient += terms) JET_BLOCKS(stride, LINEAR, JET_OF);
}

/* At one order; x is the block of the order. */
static void linear_sums(const jet_tape *tape, const jet_run *run, double *x, int lanes)
{
    if (lanes == 1) BY_TERMS(sums_of_one, tape, run, x)
    else if (lanes == 8) BY_TERMS(sums_of_eight, tape, run, x)
    else sums_of_many(tape, run, x, lanes);
}

/* To order 0 only. */
static void linear_numbers(const jet_tape *tape, const jet_run *run, double *x, int lanes)
{
    for (int i = 0; i < run->count; i++) {
        const double base = tape->base[run->first + i];
        double *z = slot_of(x, run->z + i, lanes);
        for (int w = 0; base != 0 && w < lanes; w++) z[w] += base;
    }
}

static inline __attribute__((always_inline)) void adjoints_of_one(const jet_tape *tape, const jet_run *run, double *bar,
                                                                  int terms)
{
    const int *to = tape->term_slot + run->term;
    const double *coefficient = tape->term_coefficient + run->term;
    const double *z = bar + run->z, *const end = z + run->count;
    for (; z < end; z++, to += terms, coefficient += terms) {
        const double zbar = *z;
        for (int term = 0; term < terms; term++) bar[to[term]] += coefficient[term] * zbar;
    }
}

/* One lane, at one order. */
static void linear_adjoints(const jet_tape *tape, const jet_run *run, double *bar)
{
    BY_TERMS(adjoints_of_one, tape, run, bar);
}

/* ---- The sweeps -------------------------------------------------------------------------------------------------- */

static bool values(const jet_tape *tape, double *x, int lanes)
{
    bool inside = true;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) {
        if (run->op == OP_LINEAR) {
            linear_sums(tape, run, x, lanes);
            if (run->has_numbers) linear_numbers(tape, run, x, lanes);
            continue;
        }
        inside &= jet_rules[run->op]->value(run->c, run->count * lanes, slot(x, run->a, lanes), slot(x, run->b, lanes),
                                            slot_of(x, run->z, lanes));
    }
    return inside;
}

static bool series(const jet_tape *tape, double *x, int k, int lanes)
{
    if (k == 0) return values(tape, x, lanes);
    const size_t stride = (size_t)tape->slots * (size_t)lanes;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) {
        if (run->op == OP_LINEAR) linear_sums(tape, run, x + (size_t)k * stride, lanes);
        else
            jet_rules[run->op]->series(run->c, k, stride, run->count * lanes, slot(x, run->a, lanes),
                                       slot(x, run->b, lanes), slot_of(x, run->z, lanes));
    }
    return true;
}

static void tangents(const jet_tape *tape, const double *x, double *dx, int k, int lanes)
{
    const size_t stride = (size_t)tape->slots, dstride = stride * (size_t)lanes;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) {
        if (run->op == OP_LINEAR) {
            linear_sums(tape, run, dx + (size_t)k * dstride, lanes);
            continue;
        }
        const jet_tangent members = {
            .c = run->c,
            .stride = stride,
            .dstride = dstride,
            .count = run->count,
            .lanes = lanes,
            .a = x + run->a,
            .b = x + run->b,
            .z = x + run->z,
            .da = slot(dx, run->a, lanes),
            .db = slot(dx, run->b, lanes),
            .dz = slot_of(dx, run->z, lanes),
        };
        jet_rules[run->op]->tangent(&members, k);
    }
}

static void adjoints(const jet_tape *tape, const double *x, double *bar, int k)
{
    const size_t stride = (size_t)tape->slots;
    for (const jet_run *run = tape->run + tape->runs; run-- > tape->run;) {
        if (run->op == OP_LINEAR) {
            linear_adjoints(tape, run, bar + (size_t)k * stride);
            continue;
        }
        const jet_adjoint members = {
            .c = run->c,
            .stride = stride,
            .width = run->count,
            .a = x + run->a,
            .b = x + run->b,
            .z = x + run->z,
            .abar = bar + run->a,
            .bbar = bar + run->b,
            .zbar = bar + run->z,
        };
        jet_rules[run->op]->adjoint(&members, k);
    }
}

#define COMBINE(V, S)                                                                                                  \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 0, count - 1, c[(size_t)(count - 1 - j) * of_c] * S(V, table, count - 1 - j));                 \
        JET_AT(V, out, 0) = sum;                                                                                       \
    }

static void combine(int count, const double *c, size_t of_c, int width, const double *table, double *out)
{
    const size_t stride = (size_t)width;
    JET_BLOCKS(width, COMBINE, JET_OF);
}

const jet_sweeps JET_FOR_ISA(jet_sweeps) = {values, series, tangents, adjoints, combine};
