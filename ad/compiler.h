/* compiler.h - Defines everything that the library asks of the compilers, gcc and clang: attributes, pragmas and
 * built-in functions, each with its reason. Exceptions are the queries of the processor in isa.c, the exported
 * functions of src/system/bodies.c, and the atomic counter in src/compiled/attach.c. The macros change at most the last
 * bits of results, where a sum is computed as a vector. Generated code begins with this text. */
#ifndef TVI_AD_COMPILER_H
#define TVI_AD_COMPILER_H

/* Switches off warnings that generated code would give. Generated code contains the text of all rules and calls only
 * some of them, and its constant structures leave out braces and initialisers. */
#ifdef JET_EMITTED
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-const-variable"
#pragma GCC diagnostic ignored "-Wmissing-braces"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif

/* Attributes have underscores around their names, so that they are not a word that a user may choose as the name of a
 * function (tvi_compiled_write). */

/* ---- Functions --------------------------------------------------------------------------------------------------- */

/* Inlines a function in any case. Compilers decide by size alone, but little is left of a function many of whose
 * arguments are constants. */
#define JET_INLINE static inline __attribute__((__always_inline__))

/* Keeps a function from being inlined: one that is large or rarely called, and would cost its caller registers. */
#define JET_APART static __attribute__((__noinline__, __unused__))

/* Has the compiler compare the arguments of a printf-like function with its format. `text` is the position of the
 * format among the parameters, counted from 1, and `from` that of the first argument. A function with a va_list has
 * from = 0. */
#define JET_FORMAT(text, from) __attribute__((__format__(__printf__, text, from)))
/* Marks functions that are called only when something is refused. The compiler moves code that leads to them out of
 * the way. */
#define JET_COLD __attribute__((__cold__))

/* Exempts a function from the address sanitizer, since the function copies bytes that arena.h has declared
 * inaccessible. */
#define JET_UNCHECKED __attribute__((__no_sanitize_address__))

/* ---- Vectors ----------------------------------------------------------------------------------------------------- */

/* The attribute of a vector type for `count` successive numbers at any place of an array. Such a vector has the
 * alignment of one number, and may alias the numbers of the array. */
#define JET_VECTOR(type, count)                                                                                        \
    __attribute__((__vector_size__((count) * sizeof(type)), __aligned__(sizeof(type)), __may_alias__))

/* The attribute of a vector that is passed to a function in a register. */
#define JET_REGISTER(type, count) __attribute__((__vector_size__((count) * sizeof(type))))

/* Converts a vector to a vector of another number type, such as double to float. */
#define JET_CONVERT(V, x) __builtin_convertvector(x, V)

/* Computes a b + c for numbers, as one operation if the processor has one, otherwise by a call of the mathematical
 * library. */
#define JET_FMA_OF_NUMBERS(a, b, c) __builtin_fma(a, b, c)

/* Computes a b + c for numbers, rounded once if the processor has such an operation. */
#ifdef __FMA__
#define JET_FUSED(a, b, c) JET_FMA_OF_NUMBERS(a, b, c)
#else
#define JET_FUSED(a, b, c) ((a) * (b) + (c))
#endif

/* ---- Loops ------------------------------------------------------------------------------------------------------- */

/* Unrolls the following loop, whose bound the compiler knows, so that the numbers it sets stay in registers. Without
 * the pragma gcc unrolls only short loops, and at most eight times. */
#define JET_UNROLL(most) JET_PRAGMA(GCC unroll most)
#define JET_PRAGMA(text) _Pragma(#text)

/* Keeps gcc from unrolling the following loop over lanes, so that gcc makes vectors of the lanes. In generated code gcc
 * knows the number of lanes, and would otherwise unroll the loop before it looks for vectors. */
#ifdef JET_EMITTED
#define JET_IN_VECTORS JET_UNROLL(1)
#else
#define JET_IN_VECTORS
#endif

/* Unrolls the following loop completely in generated code, so that the numbers it sets stay in registers. Elsewhere the
 * bound is a variable, and 16 copies of a loop inside 16 copies of another would only cost compile time. */
#ifdef JET_EMITTED
#define JET_UNROLLED JET_UNROLL(16)
#else
#define JET_UNROLLED
#endif

/* Tells whether the compiler knows a number as a constant. */
#define JET_KNOWS(number) __builtin_constant_p(number)

#endif
