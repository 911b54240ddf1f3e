/* emitted.h - Defines the macros from which generated code makes the sweeps of a tape: the functions that compute its
 * values and their derivatives (tape.h). The text of generated code (emit.h) contains this file after the rules of the
 * operations (rule.h).
 *
 * A tape consists of runs, each of which is one or more equal operations. In the following, T is the tape's name, and
 * T_run[i] its run with the index i. For each tape the generated text defines the macro T_RUNS, a list with one macro
 * call for each run in the order of the tape. There are three kinds of calls:
 *   - RULE(T, i, name) stands for a run of operations with the rule of this name, such as exp.
 *   - PRODUCTS(T, i, are_squares, terms) stands for a run of sums of products. Each sum has `terms` products;
 *     are_squares is 1 if all of them are squares, otherwise 0.
 *   - LINEAR(T, i, terms) stands for a run of linear combinations of `terms` operands. */
#ifndef TVI_AD_EMITTED_H
#define TVI_AD_EMITTED_H

#include "sums.h"

#define VALUES_RULE(T, i, name)                                                                                        \
    inside &= evaluate_##name(T##_run[i].exponent, T##_run[i].operation_count * lanes, x + T##_run[i].a * lanes,       \
                              x + T##_run[i].b * lanes, x + T##_run[i].z * lanes);
#define VALUES_PRODUCTS(T, i, are_squares, terms) compute_product_values(&T, &T##_run[i], x, lanes, are_squares, terms);
#define VALUES_LINEAR(T, i, terms)                                                                                     \
    compute_sums_without_constants(&T, &T##_run[i], x, lanes, terms);                                                  \
    add_constant_terms(&T, &T##_run[i], x, lanes);

#define ORDER_LINEAR(T, i, x, terms)                                                                                   \
    compute_sums_without_constants(&T, &T##_run[i], x + k * T.slot_count * lanes, lanes, terms);

#define SERIES_RULE(T, i, name) name##_series(&T##_run[i], x, k, (size_t)T.slot_count, lanes);
#define SERIES_PRODUCTS(T, i, are_squares, terms)                                                                      \
    compute_product_series_order(&T, &T##_run[i], x, k, (size_t)lanes, are_squares, terms);
#define SERIES_LINEAR(T, i, terms) ORDER_LINEAR(T, i, x, terms)

/* The instruction set for which this code is compiled. */
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
#define JET_GENERATED_ISA jet_isa_avx512
#elif defined(__AVX2__) && defined(__FMA__)
#define JET_GENERATED_ISA jet_isa_avx2
#else
#define JET_GENERATED_ISA jet_isa_base
#endif

/* The following macros define the sweeps of tape.h for the tape T. The number of lanes is an enumeration constant in
 * each function, since compilers optimise a function before they inline it. INLINED is ALWAYS, or NEVER for large
 * functions (EMIT_MAX_INLINED). */
#define ALWAYS JET_INLINE
#define NEVER  JET_APART
#define JET_GENERATED_VALUES(T, LANES, INLINED)                                                                        \
    INLINED bool T##_values_##LANES(double *x)                                                                         \
    {                                                                                                                  \
        enum { lanes = LANES };                                                                                        \
        bool inside = true;                                                                                            \
        T##_RUNS(VALUES_RULE, VALUES_PRODUCTS, VALUES_LINEAR);                                                         \
        return inside;                                                                                                 \
    }

/* Calls the value function for the `width` lanes of one vector register. */
#define VALUES_OF(T, x, width) ((width) == 8 ? T##_values_8(x) : (width) == 4 ? T##_values_4(x) : T##_values_2(x))

/* The following macros define a value function that processes the lanes of one register after the other, so that all
 * intermediate values stay in registers. It stores only the outputs. */
#define IN_A_REGISTER(V, T)                                                                                            \
    {                                                                                                                  \
        enum { width = sizeof(V) / sizeof(double) };                                                                   \
        _Alignas(64) double y[T##_slots * width];                                                                      \
        JET_UNROLL(256) for (int i = 0; i < T.input_count + T.constant_count; i++)                                     \
        {                                                                                                              \
            *(V *)(y + i * width) = *(const V *)(x + i * lanes + here);                                                \
        }                                                                                                              \
        inside &= VALUES_OF(T, y, width);                                                                              \
        JET_UNROLL(256) for (int i = 1; i <= T##_outputs; i++)                                                         \
        {                                                                                                              \
            *(V *)(x + T##_output[i] * lanes + here) = *(const V *)(y + T##_output[i] * width);                        \
        }                                                                                                              \
    }
/* The loop limits are constants, so that the compiler drops loops over vector lengths that do not occur. */
#ifdef JET_WIDE
#define IN_REGISTERS(T)                                                                                                \
    for (int here = 0; here < lanes / 8 * 8; here += 8) IN_A_REGISTER(jet_v8, T)                                       \
    for (int here = lanes / 8 * 8; lanes % 8 > 0 && here < lanes; here += 4) IN_A_REGISTER(jet_v4, T)
#elif defined(__AVX__)
#define IN_REGISTERS(T)                                                                                                \
    for (int here = 0; here < lanes; here += 4) IN_A_REGISTER(jet_v4, T)
#else
#define IN_REGISTERS(T)                                                                                                \
    for (int here = 0; here < lanes; here += 2) IN_A_REGISTER(jet_v2, T)
#endif
#define JET_VALUES_IN_REGISTERS(T, LANES)                                                                              \
    NEVER bool T##_values_##LANES(double *x)                                                                           \
    {                                                                                                                  \
        enum { lanes = LANES };                                                                                        \
        bool inside = true;                                                                                            \
        IN_REGISTERS(T)                                                                                                \
        return inside;                                                                                                 \
    }

#define JET_GENERATED_SERIES(T)                                                                                        \
    JET_INLINE bool T##_series_of_one_lane(double *x, int k)                                                           \
    {                                                                                                                  \
        enum { lanes = 1 };                                                                                            \
        if (k == 0) return T##_values_1(x);                                                                            \
        T##_RUNS(SERIES_RULE, SERIES_PRODUCTS, SERIES_LINEAR) return true;                                             \
    }

#endif
