/* compile.c - Defines tvi_compile, which compiles and loads code for a system, and tvi_compiled_write, which writes
 * it to a file. */
#include "compiled/compiled.h"
#include "compiled/files.h"
#include "refusal.h"

#include <stdlib.h>

/* Completes the options in the same way as an integrator does. */
static tvi_status resolve_options(const tvi_system *system, const tvi_options *options, tvi_options *resolved_options)
{
    if (!system) return jet_refuse(TVI_EINVAL, "system is NULL");
    *resolved_options = options ? *options : tvi_options_default();
    resolved_options->compiled = NULL;
    return tvi_options_resolve(resolved_options, system->stepped, NULL);
}

/* Compiles or loads the code, and checks that it can be used for the system. */
static tvi_status compile_and_check(tvi_compiled **out, const tvi_system *stepped_system,
                                    const tvi_options *resolved_options, const tvi_compiler *compiler)
{
    jet_text text = {0};
    tvi_compiled_write_text(&text, stepped_system, resolved_options, TVI_COMPILED_NAME);
    const jet_isa isa = stepped_system->field_values->interpreter_sweeps->isa;
    tvi_status status = text.is_incomplete ? TVI_ENOMEM : tvi_compiled_load_or_compile(out, &text, compiler, isa);
    free(text.data);
    const char *misfit = status == TVI_OK ? tvi_compiled_why_unusable(*out, stepped_system, resolved_options) : NULL;
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
    tvi_options resolved_options;
    const tvi_compiler defaults = {NULL, NULL, NULL};
    const tvi_status status = resolve_options(system, options, &resolved_options);
    return jet_explain_out_of_memory(
        status == TVI_OK ? compile_and_check(out, system->stepped, &resolved_options, compiler ? compiler : &defaults)
                         : status);
}

tvi_status tvi_compiled_write(const tvi_system *system, const tvi_options *options, const char *function_name,
                              const char *path)
{
    if (!function_name || !path) return jet_refuse(TVI_EINVAL, "%s is NULL", function_name ? "path" : "name");
    const char *why = tvi_compiled_why_name_refused(function_name);
    if (why) return jet_refuse(TVI_EINVAL, "name = \"%s\" %s", function_name, why);
    tvi_options resolved_options;
    const tvi_status status = resolve_options(system, options, &resolved_options);
    if (status != TVI_OK) return status;
    jet_text text = {0};
    tvi_compiled_write_text(&text, system->stepped, &resolved_options, function_name);
    const bool failed = text.is_incomplete, is_written = !failed && tvi_file_write(path, text.data, text.length);
    free(text.data);
    if (!failed && !is_written) return jet_refuse(TVI_ECOMPILE, "%s cannot be written", path);
    return failed ? jet_explain_out_of_memory(TVI_ENOMEM) : TVI_OK;
}
