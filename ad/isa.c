/* isa.c - Chooses the instruction set with which a new tape runs: the widest one of the processor, or a narrower one
 * that the environment variable TVI_ISA names. tape.c calls it. The rules and the sweeps are compiled once for each
 * instruction set. */
#include "tape.h"

#include <stdlib.h>
#include <string.h>

/* The interpreter of the base set, defined in sweep.c. */
extern const jet_sweeps jet_interpreter;

#ifdef JET_ISA_X86
/* The interpreters of the other sets. No source defines these names: the Makefile compiles sweep.c once more for each
 * set, and its rule named_object adds the suffix of the set to jet_interpreter and all other names of the object. */
extern const jet_sweeps jet_interpreter_avx2, jet_interpreter_avx512;

static bool has_avx2(void) { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }

static bool has_avx512(void)
{
    return has_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}

const jet_sweeps *jet_choose_sweeps_for_processor(void)
{
    const char *wish = getenv("TVI_ISA");
    if (wish && strcmp(wish, "base") == 0) return &jet_interpreter;
    if (has_avx512() && !(wish && strcmp(wish, "avx2") == 0)) return &jet_interpreter_avx512;
    return has_avx2() ? &jet_interpreter_avx2 : &jet_interpreter;
}
#else
const jet_sweeps *jet_choose_sweeps_for_processor(void) { return &jet_interpreter; }
#endif
