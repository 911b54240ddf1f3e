/* compiled.h - Makes generated code, checks it, and attaches it to the tapes of a system, where it replaces the
 * interpreter (docs/compiled.md). Integrators and tvi_compile call it. */
#ifndef TVI_SRC_COMPILED_COMPILED_H
#define TVI_SRC_COMPILED_COMPILED_H

#include "compiled/code.h"
#include "method/method.h"
#include "text.h"

/* Returns the reason why the code cannot be used on this machine for the system and these resolved options. The system
 * is the one in which steps are made (tvi_system.stepped_system). NULL: the code can be used, or there is no code. */
const char *tvi_compiled_why_unusable(const tvi_compiled *compiled, const tvi_system *stepped_system,
                                      const tvi_options *options);

/* Returns a copy of the system, allocated in the arena, whose tapes run the code. Returns the system itself if there
 * is no code, and as long as the arena has no memory. */
const tvi_system *tvi_compiled_attach_to_copy(tvi_arena *arena, const tvi_system *stepped_system,
                                              const tvi_compiled *compiled);

/* Count one user more or one less. The last user frees the code. Code that is part of the program is not counted. */
void tvi_compiled_add_user(const tvi_compiled *compiled);
void tvi_compiled_remove_user(const tvi_compiled *compiled);

/* Returns a hash of all texts of the library that generated code contains. */
uint64_t tvi_compiled_hash_library_text(void);

#define TVI_COMPILED_NAME "generated" /* The name of the function that a shared library of generated code exports. */

/* Loads the shared library for this text from the cache, or compiles the text. Returns TVI_ENOMEM or
 * TVI_ECOMPILE if it fails. */
TVI_NODISCARD tvi_status tvi_compiled_load_or_compile(tvi_compiled **out, const jet_text *text,
                                                      const tvi_compiler *compiler, jet_isa isa);

#endif
