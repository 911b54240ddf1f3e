/* code.h - what generated code defines, and where the library looks for it: part of the text of generated code. */
#ifndef TVI_SRC_COMPILED_CODE_H
#define TVI_SRC_COMPILED_CODE_H

#include "tape.h"

typedef enum { TVI_CODE_SERIES, TVI_CODE_VALUES, TVI_CODE_BEND, TVI_CODE_SECOND, TVI_CODE_TAPES } tvi_code_tape;

struct galerkin_code;
struct tvi_curve_code;

typedef struct tvi_code {
    uint64_t library, system, options;        /* what it was made by and for (fingerprint.h) */
    jet_isa isa;                              /* what it was compiled for */
    const jet_sweeps *sweeps[TVI_CODE_TAPES]; /* of the system's tapes; NULL: interpreted, as what they leave out */
    const struct galerkin_code *galerkin;     /* NULL: the library makes all steps */
    const struct tvi_curve_code *curve;       /* NULL: order by order */
} tvi_code;

struct tvi_compiled {
    const tvi_code *code;
    void *library; /* that was loaded; NULL: the code is the program's own, and users are not counted */
    int users;
};

#endif
