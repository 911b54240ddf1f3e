/* code.h - Declares what generated code defines, and where the library finds it. It is part of the text of generated
 * code. */
#ifndef TVI_SRC_COMPILED_CODE_H
#define TVI_SRC_COMPILED_CODE_H

#include "tape.h"

typedef enum { TVI_CODE_SERIES, TVI_CODE_VALUES, TVI_CODE_BEND, TVI_CODE_HESSIAN, TVI_CODE_TAPES } tvi_code_tape;

struct galerkin_code;
struct tvi_curve_code;

typedef struct tvi_code {
    uint64_t library, system, options; /* fingerprints of what it was made by and for */
    jet_isa isa;                       /* it was compiled for */
    /* Sweeps of the system's tapes; NULL, also for one of the sweeps: the tape is interpreted. */
    const jet_sweeps *sweeps[TVI_CODE_TAPES];
    const struct galerkin_code *galerkin; /* NULL: the library makes all steps */
    const struct tvi_curve_code *curve;   /* NULL: order by order */
} tvi_code;

struct tvi_compiled {
    const tvi_code *code;
    /* The loaded library. NULL: the code is part of the program, and its users are not counted. */
    void *library;
    int users;
};

#endif
