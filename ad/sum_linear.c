/* sum_linear.c - Computes z = number + sum_i coefficient_i x_i in every kind of sweep (sums.h). Values have the
 * number; series and tangents have the same sums without it. */
#include "sums.h"

/* Defines the table of functions name[terms](parameters), with one function for each number of terms up to OWN_MAX,
 * and name[0] for larger numbers. */
enum { OWN_MAX = 5 };
#define TABLE(name, body, parameters, ...)                                                                             \
    static void name##_any parameters { body(__VA_ARGS__, run->terms); }                                               \
    JET_BY_TERMS(name##_of, body, parameters, __VA_ARGS__)                                                             \
    static void name##_5 parameters { body(__VA_ARGS__, 5); }                                                          \
    static void(*const name[1 + OWN_MAX])                                                                              \
        parameters = {name##_any, name##_of_1, name##_of_2, name##_of_3, name##_of_4, name##_5};
#define FUNCTION(name, run) name[(run)->terms <= OWN_MAX ? (run)->terms : 0]

/* Computes the sums of a run in a block of one lane. */
JET_INLINE void compute_sums_one_lane(const jet_tape *tape, const jet_run *run, double *block, int terms)
{
    const int *from = tape->term_slot + run->term;
    const double *coefficient = tape->term_coefficient + run->term;
    double *z = block + run->z, *const end = z + run->operation_count;
    for (; z < end; z++, from += terms, coefficient += terms) {
        double sum = coefficient[0] * block[from[0]];
        for (int term = 1; term < terms; term++) sum += coefficient[term] * block[from[term]];
        *z = sum;
    }
}

TABLE(sums_one, compute_sums_one_lane, (const jet_tape *tape, const jet_run *run, double *block), tape, run, block)

/* Computes one sum for a vector of lanes. The pointers and coefficients of the first `kept` terms are in registers. */
#define LINEAR(V, S)                                                                                                   \
    {                                                                                                                  \
        V sum = c[0] * S(V, a[0], 0);                                                                                  \
        for (int term = 1; term < kept; term++) sum += c[term] * S(V, a[term], 0);                                     \
        for (int term = kept; term < terms; term++) sum += coefficient[term] * S(V, block, from[term]);                \
        if (constant_terms) sum += *constant_terms;                                                                    \
        JET_AT(V, z, 0) = sum;                                                                                         \
    }

/* Computes two sums without constant terms together, since the additions of a single sum would wait for each other. */
#define LINEAR_PAIR(V, S)                                                                                              \
    {                                                                                                                  \
        V sum = coefficient[0] * S(V, block, from[0]), next = coefficient[terms] * S(V, block, from[terms]);           \
        for (int term = 1; term < terms; term++) {                                                                     \
            sum += coefficient[term] * S(V, block, from[term]);                                                        \
            next += coefficient[terms + term] * S(V, block, from[terms + term]);                                       \
        }                                                                                                              \
        JET_AT(V, z, 0) = sum;                                                                                         \
        JET_AT(V, z, 1) = next;                                                                                        \
    }

/* Computes the sums of a run in a block of several lanes. `constant_terms` points to those of the run; NULL:
 * there are none. */
JET_INLINE void compute_sums_many_lanes(const jet_tape *tape, const jet_run *run, double *block, int lanes,
                                        const double *constant_terms, int terms)
{
    const size_t stride = (size_t)lanes;
    const int *from = tape->term_slot + run->term, kept = terms < OWN_MAX ? terms : OWN_MAX;
    const double *coefficient = tape->term_coefficient + run->term, *a[OWN_MAX];
    double *z = block + stride * (size_t)run->z, *const end = z + stride * (size_t)run->operation_count, c[OWN_MAX];
    if (lanes == 8 && !constant_terms && terms > OWN_MAX)
        for (; z + stride < end; z += 2 * stride, from += 2 * terms, coefficient += 2 * terms)
            JET_BLOCKS_OF_8(lanes, LINEAR_PAIR, JET_OF)
    for (; z < end; z += stride, from += terms, coefficient += terms) {
        for (int term = 0; term < kept; term++)
            a[term] = block + stride * (size_t)from[term], c[term] = coefficient[term];
        JET_BLOCKS(lanes, LINEAR, JET_OF);
        if (constant_terms) constant_terms++;
    }
}

TABLE(sums_eight, compute_sums_many_lanes, (const jet_tape *tape, const jet_run *run, double *block), tape, run, block,
      8, NULL)

JET_INLINE void compute_linear_order(const jet_tape *tape, const jet_run *run, double *block, int lanes, int terms)
{
    if (lanes == 1) compute_sums_one_lane(tape, run, block, terms);
    else compute_sums_many_lanes(tape, run, block, lanes, NULL, terms);
}

TABLE(sums_any, compute_linear_order, (const jet_tape *tape, const jet_run *run, double *block, int lanes), tape, run,
      block, lanes)

void jet_compute_linear_order(const jet_tape *tape, const jet_run *run, double *block, int lanes)
{
    if (lanes == 1) FUNCTION(sums_one, run)(tape, run, block);
    else if (lanes == 8) FUNCTION(sums_eight, run)(tape, run, block);
    else FUNCTION(sums_any, run)(tape, run, block, lanes);
}

#define ADD_NUMBER(V, S) JET_AT(V, z, 0) += base;

JET_INLINE void add_constant_terms(const jet_tape *tape, const jet_run *run, double *block, int lanes)
{
    const size_t stride = (size_t)lanes;
    if (!run->has_constant_terms) return;
    for (int i = 0; i < run->operation_count; i++) {
        const double base = tape->constant_terms[run->first_constant_term + i];
        double *z = block + (size_t)(run->z + i) * stride;
        if (base != 0) JET_BLOCKS(lanes, ADD_NUMBER, JET_OF);
    }
}

TABLE(with_numbers, compute_sums_many_lanes, (const jet_tape *tape, const jet_run *run, double *block, int lanes), tape,
      run, block, lanes, tape->constant_terms + run->first_constant_term)

void jet_compute_linear_values(const jet_tape *tape, const jet_run *run, double *block, int lanes)
{
    if (run->has_constant_terms && lanes > 8) {
        FUNCTION(with_numbers, run)(tape, run, block, lanes);
    } else {
        jet_compute_linear_order(tape, run, block, lanes);
        add_constant_terms(tape, run, block, lanes);
    }
}

/* Adds the contributions of sums to the adjoints of their terms, for one lane. If consecutive sums have a term in
 * common, as the differences between one body's position and those of others have, its contributions are summed in a
 * register. */
JET_INLINE void add_linear_adjoints(const jet_tape *tape, const jet_run *run, double *adjoints, int terms)
{
    enum { KEPT = 2 };
    const int *to = tape->term_slot + run->term;
    const double *coefficient = tape->term_coefficient + run->term;
    const double *z = adjoints + run->z, *const end = z + run->operation_count;
    const int kept = terms < KEPT ? terms : KEPT;
    double sum[KEPT] = {0};
    int slot[KEPT];
    for (int term = 0; term < kept; term++) slot[term] = to[term];
    for (; z < end; z++, to += terms, coefficient += terms) {
        const double zbar = *z;
        for (int term = 0; term < kept; term++) {
            if (to[term] != slot[term]) {
                adjoints[slot[term]] += sum[term];
                sum[term] = 0;
                slot[term] = to[term];
            }
            sum[term] += coefficient[term] * zbar;
        }
        for (int term = kept; term < terms; term++) adjoints[to[term]] += coefficient[term] * zbar;
    }
    for (int term = 0; term < kept; term++) adjoints[slot[term]] += sum[term];
}

TABLE(adjoints_one, add_linear_adjoints, (const jet_tape *tape, const jet_run *run, double *adjoints), tape, run,
      adjoints)

void jet_add_linear_adjoints(const jet_tape *tape, const jet_run *run, double *adjoints)
{
    FUNCTION(adjoints_one, run)(tape, run, adjoints);
}
