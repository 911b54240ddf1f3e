/* compile.c - Defines tvi_compile, which compiles and loads code for a system, and tvi_compiled_write, which writes the
 * code to a file. The text of the code has the sweeps of the tapes that the steps of a method run, and for "galerkin"
 * generated steps. */
#include "compiled/compiled.h"
#include "compiled/files.h"
#include "method/fingerprint.h"
#include "refusal.h"
#include "system/constraint.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* ---- The name of the function ------------------------------------------------------------------------------------ */

static const char small[] = "abcdefghijklmnopqrstuvwxyz", large[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ",
                  digits[] = "0123456789";

/* The words of C11 and C23 that begin with a small letter, and those of gcc and of directives, each between blanks. */
static const char keywords[] =
    " alignas alignof asm auto bool break case char const constexpr continue default defined do double else enum extern"
    " false float for goto if inline int long nullptr register restrict return short signed sizeof static static_assert"
    " struct switch thread_local true typedef typeof typeof_unqual union unsigned void volatile while ";
static const char *const reserved_prefixes[] = {"_", "tvi_", "jet_", "TVI_", "JET_"};

static bool is_word_in_list(const char *name, const char *list)
{
    const size_t size = strlen(name);
    for (const char *at = list; (at = strstr(at, name)); at++)
        if (at[-1] == ' ' && at[size] == ' ') return true;
    return false;
}

static bool begins_with_reserved_prefix(const char *name)
{
    for (size_t i = 0; i < sizeof reserved_prefixes / sizeof *reserved_prefixes; i++)
        if (!strncmp(name, reserved_prefixes[i], strlen(reserved_prefixes[i]))) return true;
    return false;
}

static bool is_identifier(const char *name)
{
    if (!*name || strchr(digits, *name)) return false;
    for (; *name; name++)
        if (*name != '_' && !strchr(small, *name) && !strchr(large, *name) && !strchr(digits, *name)) return false;
    return true;
}

/* Returns the reason why the generated function cannot have this name. Returns NULL if it can. Names of the C library
 * are the user's to avoid. Any other name of the text that is the same gets the prefix tvi_own_ (write_source_text). */
static const char *why_name_refused(const char *name)
{
    if (!is_identifier(name)) return "is no identifier";
    if (is_word_in_list(name, keywords)) return "is a keyword";
    if (!strcmp(name, "jet") || begins_with_reserved_prefix(name))
        return "begins as the names of this library or of the compiler do";
    return strpbrk(name, small) ? NULL : "is in capitals, as macros are";
}

/* ---- The text ---------------------------------------------------------------------------------------------------- */

/* The texts of compiled/code.h, and of galerkin/generated.h with all that it includes. The Makefile makes them by
 * ad/embed.awk in build/src/embedded_code.c and build/src/embedded_galerkin.c. */
extern const char *const tvi_embedded_code[], *const tvi_embedded_galerkin[];

static uint64_t hash_lines(uint64_t hash, const char *const lines[])
{
    for (; *lines; lines++) hash = jet_continue_hash(hash, *lines, strlen(*lines));
    return hash;
}

uint64_t tvi_compiled_hash_library_text(void)
{
    const char *const *const texts[] = {jet_embedded_rule_c_source_lines(), tvi_embedded_code, tvi_embedded_galerkin};
    uint64_t hash = JET_HASH_OF_NOTHING;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) hash = hash_lines(hash, texts[i]);
    return hash;
}

/* Writes the definition of the structure tvi_generated_code (code.h) without its end: the caller adds the pointer to
 * the generated steps. */
static void emit_code_table_initialiser(jet_text *text, const jet_emission_request *const tapes[],
                                        const tvi_system *stepped_system, const tvi_options *resolved_options)
{
    jet_text_append(text,
                    "static const tvi_generated_code tvi_this_code = {\n    "
                    ".library_text_hash = UINT64_C(%" PRIu64 "),\n    .system_hash = UINT64_C(%" PRIu64
                    "),\n    .options_hash = UINT64_C(%" PRIu64 "),\n    .isa = JET_GENERATED_ISA,\n    .sweeps = {",
                    tvi_compiled_hash_library_text(), tvi_system_fingerprint(stepped_system),
                    tvi_options_fingerprint(resolved_options));
    for (int i = 0; i < TVI_CODE_TAPES; i++) {
        if (tapes[i]->name_prefix) jet_text_append(text, "&%s_sweeps, ", tapes[i]->name_prefix);
        else jet_text_append(text, "0, ");
    }
    jet_text_append(text, "},\n");
}

/* Writes the C text that defines the function `const tvi_compiled *function_name(void)`. */
static void write_source_text(jet_text *text, const tvi_system *stepped_system, const tvi_options *resolved_options,
                              const char *function_name)
{
    /* list_tapes is the function of that name in generating/step.c, generating/both_ends.c, galerkin/galerkin.c and
     * method/verlet.c; a composition has list_tapes_of_half of method/composed.c. */
    const tvi_tapes_of_steps uses =
        tvi_choose_stepper(resolved_options, stepped_system)->list_tapes(stepped_system, resolved_options);
    const jet_emission_request *const requests[TVI_CODE_TAPES] = {
        &uses.series_tape_emission,  &uses.value_tape_emission,      &uses.r_dot_Hp_tape_emission,
        &uses.hessian_tape_emission, &uses.constraint_tape_emission, &uses.curvature_tape_emission};
    const tvi_constraints *constraints = stepped_system->constraints;
    const jet_tape *const tapes[TVI_CODE_TAPES] = {stepped_system->field_series,
                                                   stepped_system->field_values,
                                                   stepped_system->r_dot_Hp_values,
                                                   stepped_system->hessian.values,
                                                   constraints ? constraints->values : NULL,
                                                   constraints ? constraints->curvature : NULL};
    jet_text_append(text,
                    "/* Generated by tvi_compiled_write (docs/compiled.md): defines %s. Other names of this text that\n"
                    " * are the same get the prefix tvi_own_. */\n#define %s tvi_own_%s\n",
                    function_name, function_name, function_name);
    jet_emit_rule_source(text);
    for (const char *const *line = tvi_embedded_code; *line; line++) jet_text_append(text, "%s", *line);
    for (int i = 0; i < TVI_CODE_TAPES; i++)
        if (requests[i]->name_prefix) jet_emit_tape(text, tapes[i], requests[i]);
    if (uses.emit_steps) uses.emit_steps(text, stepped_system, resolved_options);
    emit_code_table_initialiser(text, requests, stepped_system, resolved_options);
    jet_text_append(text, "    .generated_steps = %s,\n};\n", uses.emit_steps ? "&tvi_generated_steps" : "0");
    jet_text_append(text,
                    "static const struct tvi_compiled tvi_this_compiled = {&tvi_this_code, 0, 0};\n#undef %s\n"
                    "extern const struct tvi_compiled *%s(void);\n"
                    "const struct tvi_compiled *%s(void)\n{\n    return &tvi_this_compiled;\n}\n",
                    function_name, function_name, function_name);
}

/* ---- Compilation ------------------------------------------------------------------------------------------------- */

/* Completes the options in the same way as an integrator does. */
static tvi_status resolve_options(const tvi_system *system, const tvi_options *options, tvi_options *resolved_options)
{
    if (!system) return jet_refuse(TVI_EINVAL, "system is NULL");
    *resolved_options = options ? *options : tvi_options_default();
    resolved_options->compiled = NULL;
    return tvi_options_resolve(resolved_options, system->stepped_system, NULL);
}

/* Compiles or loads the code, and checks that it can be used for the system. */
static tvi_status compile_and_check(tvi_compiled **out, const tvi_system *stepped_system,
                                    const tvi_options *resolved_options, const tvi_compiler *compiler)
{
    jet_text text = {0};
    write_source_text(&text, stepped_system, resolved_options, TVI_COMPILED_NAME);
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
        status == TVI_OK
            ? compile_and_check(out, system->stepped_system, &resolved_options, compiler ? compiler : &defaults)
            : status);
}

tvi_status tvi_compiled_write(const tvi_system *system, const tvi_options *options, const char *function_name,
                              const char *path)
{
    if (!function_name || !path) return jet_refuse(TVI_EINVAL, "%s is NULL", function_name ? "path" : "name");
    const char *why = why_name_refused(function_name);
    if (why) return jet_refuse(TVI_EINVAL, "name = \"%s\" %s", function_name, why);
    tvi_options resolved_options;
    const tvi_status status = resolve_options(system, options, &resolved_options);
    if (status != TVI_OK) return status;
    jet_text text = {0};
    write_source_text(&text, system->stepped_system, &resolved_options, function_name);
    const bool failed = text.is_incomplete, is_written = !failed && tvi_file_write(path, false, text.data, text.length);
    free(text.data);
    if (!failed && !is_written) return jet_refuse(TVI_ECOMPILE, "%s cannot be written", path);
    return failed ? jet_explain_out_of_memory(TVI_ENOMEM) : TVI_OK;
}
