/* compiled.h - Makes generated code, checks it, and attaches it to the tapes of a system, where it replaces the
 * interpreter (docs/compiled.md). Integrators and tvi_compile call it. */
#ifndef TVI_SRC_COMPILED_COMPILED_H
#define TVI_SRC_COMPILED_COMPILED_H

#include "compiled/code.h"
#include "method/method.h"
#include "text.h"

/* Returns the reason why the code cannot be used for the stepped system with these resolved options on this machine.
 * NULL: it can, or there is no code. */
const char *tvi_compiled_reason_unusable(const tvi_compiled *compiled, const tvi_system *stepped,
                                         const tvi_options *options);

/* Returns a copy of the system, in the arena, whose tapes run the code. Returns the system itself if there is no
 * code, and as long as the arena only measures. */
const tvi_system *tvi_compiled_attach_to_system(tvi_arena *arena, const tvi_system *stepped,
                                                const tvi_compiled *compiled);

/* Count one user more or one less. The last user frees the code. Code that is part of the program is not counted. */
void tvi_compiled_add_user(const tvi_compiled *compiled);
void tvi_compiled_remove_user(const tvi_compiled *compiled);

/* Returns the reason why the generated function cannot have this name; NULL: it can. */
const char *tvi_compiled_reason_name_refused(const char *name);

/* Writes the C text that defines `const tvi_compiled *name(void)`. */
void tvi_compiled_write_text(jet_text *text, const tvi_system *stepped, const tvi_options *resolved, const char *name);

/* Returns a hash of all texts of the library that generated code contains. */
uint64_t tvi_compiled_hash_library_text(void);

#define TVI_COMPILED_NAME "generated" /* The name of the function in shared libraries. */

/* Loads the shared library for this text from the cache, or compiles the text. TVI_ENOMEM, TVI_ECOMPILE. */
TVI_NODISCARD tvi_status tvi_compiled_load_or_compile(tvi_compiled **out, const jet_text *text,
                                                      const tvi_compiler *compiler, jet_isa isa);

#endif
