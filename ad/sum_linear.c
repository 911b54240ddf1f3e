/* sum_linear.c - Computes z = number + sum_i coefficient_i x_i. Values, series and tangents differ in the number
 * alone. */
#include "sums.h"

/* Defines name[terms](parameters): a function for each number of terms up to OWN_MAX, and name[0] for more. */
enum { OWN_MAX = 5 };
#define TABLE(name, body, parameters, ...)                                                                             \
    static void name##_any parameters { body(__VA_ARGS__, run->terms); }                                               \
    JET_BY_TERMS(name##_of, body, parameters, __VA_ARGS__)                                                             \
    static void name##_5 parameters { body(__VA_ARGS__, 5); }                                                          \
    static void(*const name[1 + OWN_MAX])                                                                              \
        parameters = {name##_any, name##_of_1, name##_of_2, name##_of_3, name##_of_4, name##_5};
#define FUNCTION(name, run) name[(run)->terms <= OWN_MAX ? (run)->terms : 0]

/* Computes sums of one lane. */
JET_INLINE void sums_of_one(const jet_tape *tape, const jet_run *run, double *x, int terms)
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

TABLE(sums_one, sums_of_one, (const jet_tape *tape, const jet_run *run, double *x), tape, run, x)

/* The first terms are in registers. */
#define LINEAR(V, S)                                                                                                   \
    {                                                                                                                  \
        V sum = c[0] * S(V, a[0], 0);                                                                                  \
        for (int term = 1; term < kept; term++) sum += c[term] * S(V, a[term], 0);                                     \
        for (int term = kept; term < terms; term++) sum += coefficient[term] * S(V, x, from[term]);                    \
        if (number) sum += *number;                                                                                    \
        JET_AT(V, z, 0) = sum;                                                                                         \
    }

/* Computes two sums without numbers together, since each alone would wait for its additions. */
#define LINEAR_PAIR(V, S)                                                                                              \
    {                                                                                                                  \
        V sum = coefficient[0] * S(V, x, from[0]), next = coefficient[terms] * S(V, x, from[terms]);                   \
        for (int term = 1; term < terms; term++) {                                                                     \
            sum += coefficient[term] * S(V, x, from[term]);                                                            \
            next += coefficient[terms + term] * S(V, x, from[terms + term]);                                           \
        }                                                                                                              \
        JET_AT(V, z, 0) = sum;                                                                                         \
        JET_AT(V, z, 1) = next;                                                                                        \
    }

/* Computes sums of several lanes. number points to the first sum's, with those of the others beside it; NULL: none. */
JET_INLINE void sums_of_many(const jet_tape *tape, const jet_run *run, double *x, int lanes, const double *number,
                             int terms)
{
    const size_t stride = (size_t)lanes;
    const int *from = tape->term_slot + run->term, kept = terms < OWN_MAX ? terms : OWN_MAX;
    const double *coefficient = tape->term_coefficient + run->term, *a[OWN_MAX];
    double *z = x + stride * (size_t)run->z, *const end = z + stride * (size_t)run->count, c[OWN_MAX];
    if (lanes == 8 && !number && terms > OWN_MAX)
        for (; z + stride < end; z += 2 * stride, from += 2 * terms, coefficient += 2 * terms)
            JET_BLOCKS_OF_8(lanes, LINEAR_PAIR, JET_OF)
    for (; z < end; z += stride, from += terms, coefficient += terms) {
        for (int term = 0; term < kept; term++) a[term] = x + stride * (size_t)from[term], c[term] = coefficient[term];
        JET_BLOCKS(lanes, LINEAR, JET_OF);
        if (number) number++;
    }
}

TABLE(sums_eight, sums_of_many, (const jet_tape *tape, const jet_run *run, double *x), tape, run, x, 8, NULL)

JET_INLINE void linear_order_of(const jet_tape *tape, const jet_run *run, double *x, int lanes, int terms)
{
    if (lanes == 1) sums_of_one(tape, run, x, terms);
    else sums_of_many(tape, run, x, lanes, NULL, terms);
}

TABLE(sums_any, linear_order_of, (const jet_tape *tape, const jet_run *run, double *x, int lanes), tape, run, x, lanes)

void jet_linear_order(const jet_tape *tape, const jet_run *run, double *x, int lanes)
{
    if (lanes == 1) FUNCTION(sums_one, run)(tape, run, x);
    else if (lanes == 8) FUNCTION(sums_eight, run)(tape, run, x);
    else FUNCTION(sums_any, run)(tape, run, x, lanes);
}

#define ADD_NUMBER(V, S) JET_AT(V, z, 0) += base;

JET_INLINE void add_numbers(const jet_tape *tape, const jet_run *run, double *x, int lanes)
{
    const size_t stride = (size_t)lanes;
    if (!run->has_numbers) return;
    for (int i = 0; i < run->count; i++) {
        const double base = tape->base[run->first + i];
        double *z = x + (size_t)(run->z + i) * stride;
        if (base != 0) JET_BLOCKS(lanes, ADD_NUMBER, JET_OF);
    }
}

TABLE(with_numbers, sums_of_many, (const jet_tape *tape, const jet_run *run, double *x, int lanes), tape, run, x, lanes,
      tape->base + run->first)

void jet_linear_values(const jet_tape *tape, const jet_run *run, double *x, int lanes)
{
    if (run->has_numbers && lanes > 8) {
        FUNCTION(with_numbers, run)(tape, run, x, lanes);
    } else {
        jet_linear_order(tape, run, x, lanes);
        add_numbers(tape, run, x, lanes);
    }
}

/* Adds the adjoints of sums of one lane. A term that several sums in a row share collects their contributions in a
 * register, as in differences of one body's position from many others. */
JET_INLINE void adjoints_of_one(const jet_tape *tape, const jet_run *run, double *bar, int terms)
{
    enum { KEPT = 2 };
    const int *to = tape->term_slot + run->term;
    const double *coefficient = tape->term_coefficient + run->term;
    const double *z = bar + run->z, *const end = z + run->count;
    const int kept = terms < KEPT ? terms : KEPT;
    double sum[KEPT] = {0};
    int slot[KEPT];
    for (int term = 0; term < kept; term++) slot[term] = to[term];
    for (; z < end; z++, to += terms, coefficient += terms) {
        const double zbar = *z;
        for (int term = 0; term < kept; term++) {
            if (to[term] != slot[term]) {
                bar[slot[term]] += sum[term];
                sum[term] = 0;
                slot[term] = to[term];
            }
            sum[term] += coefficient[term] * zbar;
        }
        for (int term = kept; term < terms; term++) bar[to[term]] += coefficient[term] * zbar;
    }
    for (int term = 0; term < kept; term++) bar[slot[term]] += sum[term];
}

TABLE(adjoints_one, adjoints_of_one, (const jet_tape *tape, const jet_run *run, double *bar), tape, run, bar)

void jet_linear_adjoint(const jet_tape *tape, const jet_run *run, double *bar)
{
    FUNCTION(adjoints_one, run)(tape, run, bar);
}
