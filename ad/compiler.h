/* compiler.h - Holds what is asked of the compilers, gcc and clang, each with its reason: attributes, pragmas, built-in
 * functions and barriers stand here, and nowhere else in ad/ and src/ but for OpenMP's, what isa.c asks, and the
 * visibility of bodies.c. None changes what is computed, but for the last bits where sums become vectors. Generated
 * code begins with this text. */
#ifndef TVI_AD_COMPILER_H
#define TVI_AD_COMPILER_H

#include "devices.h"

/* A file of generated code needs only some of the text of all rules, and slots of jets leave out braces and
 * initialisers. */
#ifdef JET_EMITTED
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-const-variable"
#pragma GCC diagnostic ignored "-Wmissing-braces"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif

/* ---- Functions --------------------------------------------------------------------------------------------------- */

/* Compilers inline by size alone: of a function with many constants for arguments little is left. */
#define JET_INLINE static inline __attribute__((always_inline))

/* A function that is seldom called, or is large, costs its caller the registers that it takes. */
#define JET_APART static __attribute__((noinline, unused))

/* The arguments of a text are compared with it, the first of them being number `from`, 0 for a va_list. */
#define JET_FORMAT(text, from) __attribute__((format(printf, text, from)))
/* Refusals: the way there is laid out behind all others. */
#define JET_COLD __attribute__((cold))

/* Copies what the address sanitizer is told not to touch (arena.h). */
#define JET_UNCHECKED __attribute__((no_sanitize_address))

/* ---- Vectors ----------------------------------------------------------------------------------------------------- */

/* A vector of `count` numbers anywhere in an array: aligned as one of them, and an alias of any of them. */
#define JET_VECTOR(type, count) __attribute__((vector_size((count) * sizeof(type)), aligned(sizeof(type)), may_alias))

/* The same as an argument of a function: a register. */
#define JET_REGISTER(type, count) __attribute__((vector_size((count) * sizeof(type))))

/* Between vectors of double and float. */
#define JET_CONVERT(V, x) __builtin_convertvector(x, V)

/* The two numbers of x in turn. gcc 11 has not clang's name. */
#ifdef __clang__
#define JET_SWAPPED(x) ((jet_v2)__builtin_shufflevector(x, x, 1, 0))
#else
#define JET_SWAPPED(x) ((jet_v2)__builtin_shuffle(x, (JET_MASK(jet_v2)){1, 0}))
#endif

/* a b + c of numbers, one operation where the processor has it; a call of the mathematical library elsewhere. */
#define JET_FMA_OF_NUMBERS(a, b, c) __builtin_fma(a, b, c)
/* floor(x) without <math.h>, of a constant a constant. */
#define JET_FLOOR(x) __builtin_floor(x)

/* ---- Loops ------------------------------------------------------------------------------------------------------- */

/* Before a loop whose bound the compiler knows, so that what it sets stays in registers: of itself gcc unrolls at most
 * eight times, and by size. */
#define JET_UNROLL(most) JET_PRAGMA(GCC unroll most)
#define JET_PRAGMA(text) _Pragma(#text)

/* Before a loop over lanes. gcc unrolls it before it could make vectors of it, where it knows how many they are. */
#ifdef JET_EMITTED
#define JET_IN_VECTORS JET_UNROLL(1)
#else
#define JET_IN_VECTORS
#endif

/* Before loops that generated code unrolls whole, so that unknowns stay in registers. Elsewhere n is a variable, and 16
 * copies of a loop within 16 copies of another would only take the compiler many seconds. */
#ifdef JET_EMITTED
#define JET_UNROLLED JET_UNROLL(16)
#else
#define JET_UNROLLED
#endif

/* In front of functions in which components and nodes stand side by side outside of loops: the flags of generated code
 * (Makefile) leave these alone, since most of it has vectors of its own. */
#if defined(__GNUC__) && !defined(__clang__)
#define JET_SIDE_BY_SIDE JET_PRAGMA(GCC optimize("tree-slp-vectorize"))
#else
#define JET_SIDE_BY_SIDE
#endif

/* Whether the compiler knows an order. JET_UPWARDS is for tests: it never does. */
#ifdef JET_UPWARDS
#define JET_KNOWS(order) false
#else
#define JET_KNOWS(order) __builtin_constant_p(order)
#endif

/* ---- Barriers ---------------------------------------------------------------------------------------------------- */

#define JET_ANYWHERE(number) __asm__("" : "+m"(number))
#if JET_WITHOUT & JET_DEVICE_BARRIERS
#define JET_SINGLY(count, number)  ((void)(count), (void)(number))
#define JET_ALONE(number)          ((void)(number))
#define JET_LEAVE_REGISTERS(array) ((void)(array))
#else

/* Stores each number of a short loop by itself. A vector load would otherwise wait for numbers that were just stored in
 * parts. Generated code with vectors of eight has not stored them in parts. */
#if defined(JET_EMITTED) && defined(__AVX512F__)
#define JET_SINGLY(count, number) ((void)(count), (void)(number))
#else
#define JET_SINGLY(count, number)                                                                                      \
    do {                                                                                                               \
        if ((count) < 8) JET_ANYWHERE(number);                                                                         \
    } while (0)
#endif

/* A number in a register of its own, and no part of a vector. */
#ifdef __SSE2__
#define JET_ALONE(number) __asm__("" : "+x"(number))
#else
#define JET_ALONE(number) JET_ANYWHERE(number)
#endif

/* A product with a number in memory is one operation, with one of a register's numbers two: what the array was is
 * unknown from here on. */
#define JET_LEAVE_REGISTERS(array) __asm__("" : "+r"(array))
#endif

#endif
