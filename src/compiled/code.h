/* code.h - Declares tvi_generated_code, the structure by which the library finds the data and functions of
 * generated code. Generated code contains this text, and defines one such structure. */
#ifndef TVI_SRC_COMPILED_CODE_H
#define TVI_SRC_COMPILED_CODE_H

#include "tape.h"

/* The tapes of a system that generated code may run (system/system.h): the series of the field, its values, the
 * gradient by q and p of r.H_p for a vector r, and the values of the field with its derivatives, the second derivatives
 * of L or H; of constraints the values with G, and the curvature (system/constraint.h). TVI_CODE_TAPES is their
 * number. */
typedef enum {
    TVI_CODE_SERIES,
    TVI_CODE_VALUES,
    TVI_CODE_R_DOT_HP,
    TVI_CODE_HESSIAN,
    TVI_CODE_CONSTRAINTS,
    TVI_CODE_CURVATURE,
    TVI_CODE_TAPES
} tvi_code_tape;

struct galerkin_generated_steps;

/* The data and functions of generated code. */
typedef struct tvi_generated_code {
    /* The hash of the source text of tvi that is part of the code (tvi_compiled_hash_library_text). If the tvi of the
     * running program has another text, the code is not used. */
    uint64_t library_text_hash;
    /* The hashes of the system and of the options for which the code was made. The code serves for no others. */
    uint64_t system_hash, options_hash;
    jet_isa isa; /* The instruction set for which the code was compiled. */
    /* The generated sweeps of each tape. If a pointer is NULL, the interpreter makes all sweeps of the tape. If a
     * function of the sweeps is NULL, the interpreter makes those sweeps. */
    const jet_sweeps *sweeps[TVI_CODE_TAPES];
    /* The generated steps of the Galerkin curve (galerkin/steps.h). NULL: the library makes the steps. */
    const struct galerkin_generated_steps *generated_steps;
} tvi_generated_code;

/* Generated code that can be attached to integrators. */
struct tvi_compiled {
    const tvi_generated_code *code;
    /* The loaded shared library. NULL: the code is part of the program, and its users are not counted. */
    void *library;
    int users;
};

#endif
