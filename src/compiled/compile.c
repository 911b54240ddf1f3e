/* compile.c - Defines tvi_compile, which compiles and loads code for a system, and tvi_compiled_write, which writes
 * it to a file. */
#include "compiled/compiled.h"
#include "compiled/files.h"
#include "refusal.h"

#include <stdlib.h>

/* Completes the options in the same way as an integrator does. */
static tvi_status resolve_options(const tvi_system *system, const tvi_options *options, tvi_options *resolved)
{
    if (!system) return jet_refuse(TVI_EINVAL, "system is NULL");
    *resolved = options ? *options : tvi_options_default();
    resolved->compiled = NULL;
    return tvi_method_resolve(resolved, system->stepped, NULL);
}

static tvi_status compile_and_check(tvi_compiled **out, const tvi_system *stepped, const tvi_options *resolved,
                                    const tvi_compiler *compiler)
{
    jet_text text = {0};
    tvi_compiled_write_text(&text, stepped, resolved, TVI_COMPILED_NAME);
    const jet_isa isa = stepped->field_values->interpreter_sweeps->isa;
    tvi_status status = text.is_incomplete ? TVI_ENOMEM : tvi_compiled_load_or_compile(out, &text, compiler, isa);
    free(text.data);
    const char *misfit = status == TVI_OK ? tvi_compiled_reason_unusable(*out, stepped, resolved) : NULL;
    if (!misfit) return status;
    tvi_compiled_free(*out);
    *out = NULL;
    return jet_refuse(TVI_ECOMPILE, "%s", misfit);
}

tvi_status tvi_compile(tvi_compiled **out, const tvi_system *system, const tvi_options *options,
                       const tvi_compiler *compiler)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    tvi_options resolved;
    const tvi_compiler defaults = {NULL, NULL, NULL};
    const tvi_status status = resolve_options(system, options, &resolved);
    return jet_explain_out_of_memory(
        status == TVI_OK ? compile_and_check(out, system->stepped, &resolved, compiler ? compiler : &defaults)
                         : status);
}

tvi_status tvi_compiled_write(const tvi_system *system, const tvi_options *options, const char *name, const char *path)
{
    if (!name || !path) return jet_refuse(TVI_EINVAL, "%s is NULL", name ? "path" : "name");
    const char *why = tvi_compiled_reason_name_refused(name);
    if (why) return jet_refuse(TVI_EINVAL, "name = \"%s\" %s", name, why);
    tvi_options resolved;
    const tvi_status status = resolve_options(system, options, &resolved);
    if (status != TVI_OK) return status;
    jet_text text = {0};
    tvi_compiled_write_text(&text, system->stepped, &resolved, name);
    const bool failed = text.is_incomplete, is_written = !failed && tvi_file_write(path, text.data, text.length);
    free(text.data);
    if (!failed && !is_written) return jet_refuse(TVI_ECOMPILE, "%s cannot be written", path);
    return failed ? jet_explain_out_of_memory(TVI_ENOMEM) : TVI_OK;
}
