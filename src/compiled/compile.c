/* compile.c - Defines tvi_compile, which compiles and loads code for a system, and tvi_compiled_write, which writes the
 * code to a file. The text of the code consists of the sweeps and loops that the steps of a method run. */
#include "compiled/compiled.h"
#include "compiled/files.h"
#include "method/fingerprint.h"
#include "refusal.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* ---- The name of the function ------------------------------------------------------------------------------------ */

static const char small[] = "abcdefghijklmnopqrstuvwxyz", large[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ",
                  digits[] = "0123456789";

/* The keywords of C and C++, each between blanks. */
static const char keywords[] =
    " alignas aligned alignof always_inline and and_eq asm auto bitand bitor bool break case catch char class compl"
    " const const_cast constexpr continue decltype default defined delete do double dynamic_cast else enum explicit"
    " export extern false float for friend goto if inline int long may_alias mutable namespace new noexcept noinline"
    " not not_eq nullptr operator or or_eq private protected public register reinterpret_cast restrict return short"
    " signed sizeof static static_assert static_cast std struct switch template this thread_local throw true try "
    "typedef"
    " typeid typename typeof union unsigned using vector_size virtual void volatile wchar_t while xor xor_eq ";
/* The types, macros and functions of the C library and of much of POSIX. names_with_suffixes are functions that also
 * exist with f and l at the end of their names. */
static const char library_names[] =
    " abort abs accept access alarm aligned_alloc alloca asctime assert at_quick_exit atexit atof atoi atol atoll"
    " bcopy bind brk bsearch btowc bzero c16rtomb c32rtomb call_once calloc char16_t char32_t chdir chmod chown"
    " clearerr clock clock_t close cnd_broadcast cnd_destroy cnd_init cnd_signal cnd_timedwait cnd_wait complex"
    " connect creat ctime difftime div double_t drand48 dup environ errno execv execve exit fclose feclearexcept"
    " fegetenv fegetexceptflag fegetround feholdexcept feof feraiseexcept ferror fesetenv fesetexceptflag fesetround"
    " fetestexcept feupdateenv fexcept_t fflush fgetc fgetpos fgets fgetwc fgetws float_t fopen fork fpclassify fpos_t"
    " fprintf fputc fputs fputwc fputws fread free freopen fscanf fseek fsetpos fstat fsync ftell fwide fwprintf"
    " fwrite fwscanf gamma getc getchar getenv getline getpid getuid getwc getwchar gmtime imaxabs imaxdiv index"
    " int16_t int32_t int64_t int8_t int_fast16_t int_fast32_t int_fast64_t int_fast8_t int_least16_t int_least32_t"
    " int_least64_t int_least8_t intmax_t intptr_t ioctl isalnum isalpha isatty isblank iscntrl isdigit isfinite"
    " isgraph isgreater isgreaterequal isinf isless islessequal islessgreater islower isnan isnormal isprint ispunct"
    " isspace isunordered isupper iswalnum iswalpha iswblank iswcntrl iswctype iswdigit iswgraph iswlower iswprint"
    " iswpunct iswspace iswupper iswxdigit isxdigit j0 j1 jn kill kill_dependency labs ldiv link i386 linux listen "
    "llabs"
    " lldiv localeconv localtime longjmp lseek main malloc math_errhandling mblen mbrlen mbrtoc16 mbrtoc32 mbrtowc"
    " mbsinit mbsrtowcs mbstate_t mbstowcs mbtowc memchr memcmp memcpy memmove memset mkdir mktime mmap mtx_destroy"
    " mtx_init mtx_lock mtx_timedlock mtx_trylock mtx_unlock munmap nice noreturn offsetof once_flag open pause perror"
    " pipe poll printf ptrdiff_t putc putchar putenv puts putwc putwchar qsort quick_exit raise rand random read"
    " realloc recv remove rename rewind rindex rmdir sbrk scanf select send setbuf setenv setjmp setlocale setvbuf"
    " sig_atomic_t signal signbit signgam size_t sleep snprintf socket sprintf srand srandom sscanf stat stderr stdin"
    " stdout strcat strchr strcmp strcoll strcpy strcspn strdup strerror strftime strlen strncat strncmp strncpy"
    " strpbrk strrchr strspn strstr strtod strtof strtoimax strtok strtok_r strtol strtold strtoll strtoul strtoull"
    " strtoumax strxfrm swprintf swscanf symlink sync system thrd_create thrd_current thrd_detach thrd_equal thrd_exit"
    " thrd_join thrd_sleep thrd_t thrd_yield time time_t times timespec_get tmpfile tmpnam tolower toupper towctrans"
    " towlower towupper tss_create tss_delete tss_get tss_set tss_t uint16_t uint32_t uint64_t uint8_t uint_fast16_t"
    " uint_fast32_t uint_fast64_t uint_fast8_t uint_least16_t uint_least32_t uint_least64_t uint_least8_t uintmax_t"
    " uintptr_t ungetc ungetwc unix unlink usleep va_arg va_copy va_end va_list va_start vfprintf vfscanf vfwprintf"
    " vfwscanf vprintf vscanf vsnprintf vsprintf vsscanf vswprintf vswscanf vwprintf vwscanf wait wcrtomb wcscat"
    " wcschr wcscmp wcscoll wcscpy wcscspn wcsftime wcslen wcsncat wcsncmp wcsncpy wcspbrk wcsrchr wcsrtombs wcsspn"
    " wcsstr wcstod wcstof wcstoimax wcstok wcstol wcstold wcstoll wcstombs wcstoul wcstoull wcstoumax wcsxfrm wctob"
    " wctomb wctrans wctrans_t wctype wctype_t wint_t wmemchr wmemcmp wmemcpy wmemmove wmemset wprintf write wscanf y0"
    " y1 yn ";
static const char names_with_suffixes[] =
    " acos acosh asin asinh atan atan2 atanh cabs cacos cacosh carg casin casinh catan catanh cbrt ccos ccosh ceil"
    " cexp cimag clog conj copysign cos cosh cpow cproj creal csin csinh csqrt ctan ctanh erf erfc exp exp2 expm1 fabs"
    " fdim floor fma fmax fmin fmod frexp hypot ilogb ldexp lgamma llrint llround log log10 log1p log2 logb lrint"
    " lround modf nan nearbyint nextafter nexttoward pow remainder remquo rint round scalbln scalbn sin sinh sqrt tan"
    " tanh tgamma trunc ";
static const char *const reserved_prefixes[] = {"tvi_", "jet_", "TVI_", "JET_", "Sleef_"}, *const library_prefixes[] = {
                                                                                               "atomic_"};

static bool is_word_in_list(const char *name, const char *list)
{
    const size_t size = strlen(name);
    for (const char *at = list; (at = strstr(at, name)); at++)
        if (at[-1] == ' ' && at[size] == ' ') return true;
    return false;
}

static bool begins_with_any_prefix(const char *name, const char *const prefix[], size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!strncmp(name, prefix[i], strlen(prefix[i]))) return true;
    return false;
}

enum { MAX_NAME_LENGTH = 32 /* All names in these lists are shorter. */ };

static bool is_c_library_name(const char *name)
{
    char type[MAX_NAME_LENGTH];
    const size_t size = strlen(name);
    if (is_word_in_list(name, library_names) || is_word_in_list(name, names_with_suffixes)) return true;
    if (begins_with_any_prefix(name, library_prefixes, sizeof library_prefixes / sizeof *library_prefixes)) return true;
    if (size < 2 || size >= MAX_NAME_LENGTH || !strchr("fl", name[size - 1])) return false;
    memcpy(type, name, size - 1);
    type[size - 1] = 0;
    return is_word_in_list(type, names_with_suffixes);
}

static bool is_identifier(const char *name)
{
    if (!*name || strchr(digits, *name)) return false;
    for (; *name; name++)
        if (*name != '_' && !strchr(small, *name) && !strchr(large, *name) && !strchr(digits, *name)) return false;
    return true;
}

/* Returns the reason why the generated function cannot have this name. Returns NULL if it can. Names are refused that
 * belong to C, C++, the C library or this library. If a variable in the text of one system has the same name as the
 * function, the variable is renamed instead (write_source_text). */
static const char *why_name_refused(const char *name)
{
    if (!is_identifier(name)) return "is no identifier";
    if (is_word_in_list(name, keywords)) return "is a word of C or C++";
    if (is_c_library_name(name)) return "is a name of the C library";
    if (*name == '_') return "begins with _, as the names of the compiler do";
    if (!strcmp(name, "jet") ||
        begins_with_any_prefix(name, reserved_prefixes, sizeof reserved_prefixes / sizeof *reserved_prefixes))
        return "begins as the names of this library do";
    return strpbrk(name, small) ? NULL : "is in capitals, as macros are";
}

/* ---- The text ---------------------------------------------------------------------------------------------------- */

extern const char *const tvi_embedded_code[], *const tvi_embedded_galerkin[], *const tvi_embedded_curve[];
extern const char *const tvi_embedded_galerkin_plain[], *const tvi_embedded_galerkin_lagrangian[];
extern const char *const tvi_embedded_galerkin_hamiltonian[];
extern const char *const tvi_embedded_products[], *const tvi_embedded_generated_curve[];

static uint64_t hash_lines(uint64_t hash, const char *const lines[])
{
    for (; *lines; lines++) hash = jet_continue_hash(hash, *lines, strlen(*lines));
    return hash;
}

uint64_t tvi_compiled_hash_library_text(void)
{
    const char *const *const texts[] = {jet_embedded_rule_c_source_lines(),
                                        tvi_embedded_code,
                                        tvi_embedded_galerkin,
                                        tvi_embedded_galerkin_plain,
                                        tvi_embedded_galerkin_lagrangian,
                                        tvi_embedded_galerkin_hamiltonian,
                                        tvi_embedded_curve,
                                        tvi_embedded_products,
                                        tvi_embedded_generated_curve};
    uint64_t hash = JET_HASH_OF_NOTHING;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) hash = hash_lines(hash, texts[i]);
    return hash;
}

/* Writes the definition of the structure tvi_generated_code_table (code.h) without its end: the caller adds the pointer
 * to the loops. */
static void emit_code_table_initialiser(jet_text *text, const jet_emission_request *const tapes[],
                                        const tvi_system *stepped_system, const tvi_options *resolved_options)
{
    jet_text_append(text,
                    "static const tvi_generated_code_table tvi_generated_code = {\n    "
                    ".library_source_hash_when_generated = UINT64_C(%" PRIu64 "),\n    .system_hash = UINT64_C(%" PRIu64
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
    const tvi_tapes_of_steps uses = tvi_choose_stepper(resolved_options)->list_tapes(stepped_system, resolved_options);
    const jet_emission_request *const requests[TVI_CODE_TAPES] = {&uses.series_tape_emission, &uses.value_tape_emission,
                                                                  &uses.r_dot_Hp_tape_emission,
                                                                  &uses.hessian_tape_emission};
    const jet_tape *const tapes[TVI_CODE_TAPES] = {stepped_system->field_series, stepped_system->field_values,
                                                   stepped_system->r_dot_Hp_values, stepped_system->hessian_values};
    jet_text_append(text,
                    "/* Generated by tvi_compiled_write (docs/compiled.md): defines %s. Variables and functions\n"
                    " * of this text with the same name are renamed. */\n#define %s tvi_own_%s\n",
                    function_name, function_name, function_name);
    jet_emit_rule_source(text);
    for (const char *const *line = tvi_embedded_code; *line; line++) jet_text_append(text, "%s", *line);
    for (int i = 0; i < TVI_CODE_TAPES; i++)
        if (requests[i]->name_prefix) jet_emit_tape(text, tapes[i], requests[i]);
    if (uses.emit_loops) uses.emit_loops(text, stepped_system, resolved_options);
    emit_code_table_initialiser(text, requests, stepped_system, resolved_options);
    if (uses.emit_loops) jet_text_append(text, "    .%s = &tvi_loops,\n", uses.loops_pointer_name);
    jet_text_append(text, "};\n");
    jet_text_append(text,
                    "static const struct tvi_compiled tvi_generated = {&tvi_generated_code, 0, 0};\n#undef %s\n"
                    "extern const struct tvi_compiled *%s(void);\n"
                    "const struct tvi_compiled *%s(void)\n{\n    return &tvi_generated;\n}\n",
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
