/* sum_linear.c - Computes z = number + sum_i coefficient_i x_i for the values, series, tangents and adjoints of a tape
 * (sums.h). The number, called the constant term, belongs to the values, which are order 0. Higher orders of a series,
 * and tangents, are the same sums without the constant term. */
#include "sums.h"

/* TABLE defines the table of functions name[term_count](parameters). Sums of up to SPECIALISED_TERMS_MAX terms have a
 * function for each number of terms, and name[0] is for longer sums. */
enum { SPECIALISED_TERMS_MAX = 5 };
#define TABLE(name, body, parameters, ...)                                                                             \
    static void name##_any parameters { body(__VA_ARGS__, run->term_count); }                                          \
    JET_BY_TERMS(name##_of, body, parameters, __VA_ARGS__)                                                             \
    static void name##_5 parameters { body(__VA_ARGS__, 5); }                                                          \
    static void(*const name[1 + SPECIALISED_TERMS_MAX])                                                                \
        parameters = {name##_any, name##_of_1, name##_of_2, name##_of_3, name##_of_4, name##_5};
#define FUNCTION(name, run) name[(run)->term_count <= SPECIALISED_TERMS_MAX ? (run)->term_count : 0]

/* Computes the sums of a run, without constant terms, in a block of one lane. */
JET_INLINE void compute_sums_of_one_lane(const jet_tape *tape, const jet_run_of_operations *run, double *block,
                                         int term_count)
{
    const int *from = tape->terms.slot + run->first_term_index;
    const double *coefficient = tape->terms.coefficient + run->first_term_index;
    double *z = block + run->z, *const end = z + run->operation_count;
    for (; z < end; z++, from += term_count, coefficient += term_count) {
        double sum = coefficient[0] * block[from[0]];
        for (int term = 1; term < term_count; term++) sum += coefficient[term] * block[from[term]];
        *z = sum;
    }
}

TABLE(sums_one, compute_sums_of_one_lane, (const jet_tape *tape, const jet_run_of_operations *run, double *block), tape,
      run, block)

/* Computes one sum for a vector of lanes. The first `kept` terms have their pointers and coefficients in registers, and
 * the other terms in memory. */
#define LINEAR(V, S)                                                                                                   \
    {                                                                                                                  \
        V sum = c[0] * S(V, a[0], 0);                                                                                  \
        for (int term = 1; term < kept; term++) sum += c[term] * S(V, a[term], 0);                                     \
        for (int term = kept; term < term_count; term++) sum += coefficient[term] * S(V, block, from[term]);           \
        if (constant_terms) sum += *constant_terms;                                                                    \
        JET_AT(V, z, 0) = sum;                                                                                         \
    }

/* Computes two sums without constant terms together, since the additions of a single sum would wait for each other. */
#define LINEAR_PAIR(V, S)                                                                                              \
    {                                                                                                                  \
        V sum = coefficient[0] * S(V, block, from[0]), next = coefficient[term_count] * S(V, block, from[term_count]); \
        for (int term = 1; term < term_count; term++) {                                                                \
            sum += coefficient[term] * S(V, block, from[term]);                                                        \
            next += coefficient[term_count + term] * S(V, block, from[term_count + term]);                             \
        }                                                                                                              \
        JET_AT(V, z, 0) = sum;                                                                                         \
        JET_AT(V, z, 1) = next;                                                                                        \
    }

/* Computes the sums of a run in a block of several lanes. `constant_terms` points to the constant terms of the run;
 * NULL: they are left out. */
JET_INLINE void compute_sums_of_many_lanes(const jet_tape *tape, const jet_run_of_operations *run, double *block,
                                           int lanes, const double *constant_terms, int term_count)
{
    const size_t stride = (size_t)lanes;
    const int *from = tape->terms.slot + run->first_term_index,
              kept = term_count < SPECIALISED_TERMS_MAX ? term_count : SPECIALISED_TERMS_MAX;
    const double *coefficient = tape->terms.coefficient + run->first_term_index, *a[SPECIALISED_TERMS_MAX];
    double *z = block + stride * (size_t)run->z, *const end = z + stride * (size_t)run->operation_count,
           c[SPECIALISED_TERMS_MAX];
    if (lanes == 8 && !constant_terms && term_count > SPECIALISED_TERMS_MAX)
        for (; z + stride < end; z += 2 * stride, from += 2 * term_count, coefficient += 2 * term_count)
            JET_BLOCKS_OF_8(lanes, LINEAR_PAIR, JET_OF)
    for (; z < end; z += stride, from += term_count, coefficient += term_count) {
        for (int term = 0; term < kept; term++)
            a[term] = block + stride * (size_t)from[term], c[term] = coefficient[term];
        JET_BLOCKS(lanes, LINEAR, JET_OF);
        if (constant_terms) constant_terms++;
    }
}

TABLE(sums_eight, compute_sums_of_many_lanes, (const jet_tape *tape, const jet_run_of_operations *run, double *block),
      tape, run, block, 8, NULL)

JET_INLINE void compute_sums_without_constants(const jet_tape *tape, const jet_run_of_operations *run, double *block,
                                               int lanes, int term_count)
{
    if (lanes == 1) compute_sums_of_one_lane(tape, run, block, term_count);
    else compute_sums_of_many_lanes(tape, run, block, lanes, NULL, term_count);
}

TABLE(sums_any, compute_sums_without_constants,
      (const jet_tape *tape, const jet_run_of_operations *run, double *block, int lanes), tape, run, block, lanes)

void jet_compute_linear_part(const jet_tape *tape, const jet_run_of_operations *run, double *block, int lanes)
{
    if (lanes == 1) FUNCTION(sums_one, run)(tape, run, block);
    else if (lanes == 8) FUNCTION(sums_eight, run)(tape, run, block);
    else FUNCTION(sums_any, run)(tape, run, block, lanes);
}

#define ADD_CONSTANT_TERM(V, S) JET_AT(V, z, 0) += constant_term;

JET_INLINE void add_constant_terms(const jet_tape *tape, const jet_run_of_operations *run, double *block, int lanes)
{
    const size_t stride = (size_t)lanes;
    if (!run->has_nonzero_constant_terms) return;
    for (int i = 0; i < run->operation_count; i++) {
        const double constant_term = tape->constant_terms[run->first_constant_term_index + i];
        double *z = block + (size_t)(run->z + i) * stride;
        if (constant_term != 0) JET_BLOCKS(lanes, ADD_CONSTANT_TERM, JET_OF);
    }
}

TABLE(sums_with_constants, compute_sums_of_many_lanes,
      (const jet_tape *tape, const jet_run_of_operations *run, double *block, int lanes), tape, run, block, lanes,
      tape->constant_terms + run->first_constant_term_index)

void jet_compute_linear_values(const jet_tape *tape, const jet_run_of_operations *run, double *block, int lanes)
{
    if (run->has_nonzero_constant_terms && lanes > 8) {
        FUNCTION(sums_with_constants, run)(tape, run, block, lanes);
    } else {
        jet_compute_linear_part(tape, run, block, lanes);
        add_constant_terms(tape, run, block, lanes);
    }
}

/* Adds the contributions of sums to the adjoints of their terms, for one lane. If consecutive sums have a term in
 * common, as the differences between one body's position and those of others have, its contributions are summed in a
 * register. */
JET_INLINE void add_linear_adjoints(const jet_tape *tape, const jet_run_of_operations *run, double *adjoints,
                                    int term_count)
{
    enum { KEPT = 2 };
    const int *to = tape->terms.slot + run->first_term_index;
    const double *coefficient = tape->terms.coefficient + run->first_term_index;
    const double *z = adjoints + run->z, *const end = z + run->operation_count;
    const int kept = term_count < KEPT ? term_count : KEPT;
    double sum[KEPT] = {0};
    int slot[KEPT];
    for (int term = 0; term < kept; term++) slot[term] = to[term];
    for (; z < end; z++, to += term_count, coefficient += term_count) {
        const double zbar = *z;
        for (int term = 0; term < kept; term++) {
            if (to[term] != slot[term]) {
                adjoints[slot[term]] += sum[term];
                sum[term] = 0;
                slot[term] = to[term];
            }
            sum[term] += coefficient[term] * zbar;
        }
        for (int term = kept; term < term_count; term++) adjoints[to[term]] += coefficient[term] * zbar;
    }
    for (int term = 0; term < kept; term++) adjoints[slot[term]] += sum[term];
}

TABLE(adjoints_one, add_linear_adjoints, (const jet_tape *tape, const jet_run_of_operations *run, double *adjoints),
      tape, run, adjoints)

void jet_add_linear_adjoints(const jet_tape *tape, const jet_run_of_operations *run, double *adjoints)
{
    FUNCTION(adjoints_one, run)(tape, run, adjoints);
}
