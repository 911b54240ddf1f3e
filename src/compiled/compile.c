/* compile.c - Defines tvi_compile and tvi_compiled_write. */
#include "compiled/compiled.h"
#include "compiled/files.h"
#include "refusal.h"

#include <stdlib.h>

/* Resolves the options as an integrator does. */
static tvi_status resolve(const tvi_system *system, const tvi_options *options, tvi_options *resolved)
{
    if (!system) return jet_refuse(TVI_EINVAL, "system is NULL");
    *resolved = options ? *options : tvi_options_default();
    resolved->compiled = NULL;
    return tvi_method_resolve(resolved, system->stepped, NULL);
}

static tvi_status compile(tvi_compiled **out, const tvi_system *stepped, const tvi_options *resolved,
                          const tvi_compiler *how)
{
    jet_text text = {0};
    tvi_compiled_text(&text, stepped, resolved, TVI_COMPILED_NAME);
    const jet_isa isa = stepped->field_values->interpreted->isa;
    tvi_status status = text.failed ? TVI_ENOMEM : tvi_compiled_load(out, &text, how, isa);
    free(text.data);
    const char *misfit = status == TVI_OK ? tvi_compiled_misfit(*out, stepped, resolved) : NULL;
    if (!misfit) return status;
    tvi_compiled_free(*out);
    *out = NULL;
    return jet_refuse(TVI_ECOMPILE, "%s", misfit);
}

tvi_status tvi_compile(tvi_compiled **out, const tvi_system *system, const tvi_options *options,
                       const tvi_compiler *how)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    tvi_options resolved;
    const tvi_compiler usual = {NULL, NULL, NULL};
    const tvi_status status = resolve(system, options, &resolved);
    return jet_refuse_memory(status == TVI_OK ? compile(out, system->stepped, &resolved, how ? how : &usual) : status);
}

tvi_status tvi_compiled_write(const tvi_system *system, const tvi_options *options, const char *name, const char *path)
{
    if (!name || !path) return jet_refuse(TVI_EINVAL, "%s is NULL", name ? "path" : "name");
    const char *why = tvi_compiled_misnamed(name);
    if (why) return jet_refuse(TVI_EINVAL, "name = \"%s\" %s", name, why);
    tvi_options resolved;
    const tvi_status status = resolve(system, options, &resolved);
    if (status != TVI_OK) return status;
    jet_text text = {0};
    tvi_compiled_text(&text, system->stepped, &resolved, name);
    const bool failed = text.failed, is_written = !failed && tvi_file_write(path, text.data, text.size);
    free(text.data);
    if (!failed && !is_written) return jet_refuse(TVI_ECOMPILE, "%s cannot be written", path);
    return failed ? jet_refuse_memory(TVI_ENOMEM) : TVI_OK;
}
