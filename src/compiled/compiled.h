/* compiled.h - Makes generated code, checks it, and attaches it to the tapes of a system, where it runs in place of the
 * interpreter. Integrators and tvi_compile call it. */
#ifndef TVI_SRC_COMPILED_COMPILED_H
#define TVI_SRC_COMPILED_COMPILED_H

#include "compiled/code.h"
#include "method/method.h"
#include "text.h"

/* NULL if there is no code, or if it serves the stepped system with these resolved options on this machine; otherwise
 * the reason why it does not. */
const char *tvi_compiled_misfit(const tvi_compiled *compiled, const tvi_system *stepped, const tvi_options *options);

/* The system with the code in its tapes, in the arena. It is the system itself if there is no code, and as long as the
 * arena only measures. */
const tvi_system *tvi_compiled_system(tvi_arena *arena, const tvi_system *stepped, const tvi_compiled *compiled);

/* Count one user more or less; the last one frees the code. Code that is part of the program is not counted. */
void tvi_compiled_hold(const tvi_compiled *compiled);
void tvi_compiled_release(const tvi_compiled *compiled);

/* The reason why the function cannot have the name; NULL: it can. */
const char *tvi_compiled_misnamed(const char *name);

/* Writes C that defines `const tvi_compiled *name(void)`. */
void tvi_compiled_text(jet_text *text, const tvi_system *stepped, const tvi_options *resolved, const char *name);

/* A hash of all text that generated code consists of. */
uint64_t tvi_compiled_library(void);

#define TVI_COMPILED_NAME "generated" /* the function in shared libraries */

/* Loads the shared library of the text from the cache, or compiles it. TVI_ENOMEM, TVI_ECOMPILE. */
TVI_NODISCARD tvi_status tvi_compiled_load(tvi_compiled **out, const jet_text *text, const tvi_compiler *how,
                                           jet_isa isa);

#endif
