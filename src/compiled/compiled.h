/* compiled.h - generated code in the place of interpreted tapes: made, checked, and given to the steppers as another
 * instruction set of the system's tapes. */
#ifndef TVI_SRC_COMPILED_COMPILED_H
#define TVI_SRC_COMPILED_COMPILED_H

#include "compiled/code.h"
#include "method/method.h"
#include "text.h"

/* NULL where the code, if there is any, serves the system that steps are made of with these options, as resolved, on
 * this machine; else why it does not. */
const char *tvi_compiled_misfit(const tvi_compiled *compiled, const tvi_system *stepped, const tvi_options *options);

/* The system with the code in its tapes, in the arena; the system itself where there is no code, and while the arena
 * only measures. */
const tvi_system *tvi_compiled_system(tvi_arena *arena, const tvi_system *stepped, const tvi_compiled *compiled);

/* One user more or less; the last one frees. Code of the program's own is nobody's. */
void tvi_compiled_hold(const tvi_compiled *compiled);
void tvi_compiled_release(const tvi_compiled *compiled);

/* Why the function cannot have the name; NULL: it can. */
const char *tvi_compiled_misnamed(const char *name);

/* C that defines `const tvi_compiled *name(void)`. */
void tvi_compiled_text(jet_text *text, const tvi_system *stepped, const tvi_options *resolved, const char *name);

/* The version of all text that generated code consists of. */
uint64_t tvi_compiled_library(void);

#define TVI_COMPILED_NAME "generated" /* of the function in shared libraries */

/* The shared library of the text: the one in the cache, or a new one, loaded. TVI_ENOMEM, TVI_ECOMPILE. */
TVI_NODISCARD tvi_status tvi_compiled_load(tvi_compiled **out, const jet_text *text, const tvi_compiler *how,
                                           jet_isa isa);

#endif
