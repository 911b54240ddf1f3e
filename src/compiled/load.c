/* load.c - Compiles the text of generated code, and loads the shared library. It compiles in a temporary directory,
 * and then moves the library to the cache, under a name that is a hash of everything the library was made from. Each
 * file in the cache ends with a seal, so that a damaged or foreign file is detected and compiled again. */
#include "compiled/compiled.h"
#include "compiled/files.h"
#include "refusal.h"

#ifdef JET_ISA_X86
#include <cpuid.h>
#elif defined(__linux__)
#include <sys/auxv.h>
#endif
#include <dlfcn.h>
#include <inttypes.h>
#ifdef __ELF__
#include <link.h>
#endif
#include <stdlib.h>
#include <string.h>

/* The compiler flags for each of the library's instruction sets. */
static const char *const flags_of[JET_ISA_COUNT] = {TVI_COMPILED_FLAGS};

/* The compiler's arguments after its flags. */
static char *const last_arguments[] = {"-w", "-shared", "-fPIC", TVI_COMPILED_SLEEF "-lm"};
enum { LAST_ARGUMENTS = sizeof last_arguments / sizeof *last_arguments };

/* The key of a compilation: a hash of 128 bits of the text, the compiler, its flags and the processor. */
typedef struct {
    uint64_t hash[2];
} compilation_key;

/* The seal: the last bytes of a file in the cache. `magic` is the same text in every seal. */
typedef struct {
    char magic[8];
    compilation_key key;
    uint64_t checksum; /* Hash of all bytes before the seal. */
} cache_seal;

/* A request to compile. compiler_command is the name of the compiler, which other arguments may follow. The command and
 * the flags come from the user, the environment or the library. */
typedef struct {
    const char *compiler_command, *flags;
    /* The directory of the cache; without a cache, the directory for temporary files, such as /tmp. */
    jet_text cache_or_temporary_directory;
    bool uses_cache; /* The compiled library is stored in the cache. */
    compilation_key key;
} compilation_request;

/* The paths of the temporary directory and the files of one compilation; `output` is what the compiler prints. */
typedef struct {
    jet_text temporary_directory, source, library, output;
} compilation_files;

/* ---- Requests ---------------------------------------------------------------------------------------------------- */

/* Appends the path of a file or directory, given relative to a directory. The path begins with / or ./, so that no
 * compiler takes it for an option. */
static void append_joined_path(jet_text *path, const char *directory, const char *relative_path)
{
    jet_text_append(path, "%s%s%s", *directory == '/' ? "" : "./", directory, relative_path);
}

/* Returns the path that a variable of the environment contains. NULL: the variable is not set, or its path is
 * relative. */
static const char *absolute_environment_path(const char *variable)
{
    const char *path = tvi_environment_variable(variable);
    return path && *path == '/' ? path : NULL;
}

/* Sets the directory of the cache, which the user, XDG_CACHE_HOME or HOME names. The user requests no cache by an empty
 * name. Without a cache, the directory is the one for temporary files. */
static void choose_cache_directory(compilation_request *request, const char *requested_directory)
{
    const char *home = absolute_environment_path("HOME"), *user = absolute_environment_path("XDG_CACHE_HOME");
    request->uses_cache = !requested_directory || *requested_directory;
    if (requested_directory && *requested_directory)
        append_joined_path(&request->cache_or_temporary_directory, requested_directory, "");
    else if (!request->uses_cache || (!home && !user)) {
        const char *temporary = tvi_environment_variable("TMPDIR");
        request->uses_cache = false;
        append_joined_path(&request->cache_or_temporary_directory, temporary ? temporary : "/tmp", "");
    } else if (user) append_joined_path(&request->cache_or_temporary_directory, user, "/tvi");
    else append_joined_path(&request->cache_or_temporary_directory, home, "/.cache/tvi");
}

static void add_to_key(compilation_key *key, const void *data, size_t byte_count)
{
    for (int i = 0; i < 2; i++) key->hash[i] = jet_continue_hash(key->hash[i], data, byte_count);
}

/* Adds the features of this processor to the key, since the compiler's flag "native" depends on them. */
static void add_processor_to_key(compilation_key *key)
{
#ifdef JET_ISA_X86
    unsigned id[8] = {0}, of_core;
    __get_cpuid(1, &id[0], &of_core, &id[1], &id[2]);
    __get_cpuid_count(7, 0, &id[3], &id[4], &id[5], &id[6]);
    add_to_key(key, id, sizeof id);
#elif defined(__linux__)
    const unsigned long features[] = {getauxval(AT_HWCAP), getauxval(AT_HWCAP2)};
    add_to_key(key, features, sizeof features);
#else
    (void)key;
#endif
}

static compilation_request make_compilation_request(const jet_text *text, const tvi_compiler *compiler, jet_isa isa)
{
    const char *named = tvi_environment_variable("CC"); /* A CC of blanks names no compiler. */
    const char *default_compiler = named && named[strspn(named, " \t\n")] ? named : "cc";
    compilation_request request = {.compiler_command = compiler->compiler ? compiler->compiler : default_compiler,
                                   .flags = compiler->flags ? compiler->flags : flags_of[isa],
                                   .key = {{JET_HASH_OF_NOTHING, ~JET_HASH_OF_NOTHING}}};
    choose_cache_directory(&request, compiler->cache);
    add_to_key(&request.key, text->data, text->length);
    add_to_key(&request.key, request.compiler_command, strlen(request.compiler_command) + 1);
    add_to_key(&request.key, request.flags, strlen(request.flags) + 1);
    for (int i = 0; i < LAST_ARGUMENTS; i++) add_to_key(&request.key, last_arguments[i], strlen(last_arguments[i]) + 1);
    add_processor_to_key(&request.key);
    return request;
}

/* ---- Seals ------------------------------------------------------------------------------------------------------- */

static cache_seal compute_seal(const compilation_key *key, const char *data, size_t byte_count)
{
    return (cache_seal){
        {'t', 'v', 'i', ' ', 'c', 'o', 'd', 'e'}, *key, jet_continue_hash(JET_HASH_OF_NOTHING, data, byte_count)};
}

/* Tells whether the file exists, and ends with the seal for this key and its contents. */
static bool has_valid_seal(const char *path, const compilation_key *key)
{
    size_t byte_count;
    char *data = tvi_file_read(path, &byte_count);
    bool is_there = false;
    if (data && byte_count > sizeof(cache_seal)) {
        const cache_seal wanted = compute_seal(key, data, byte_count - sizeof wanted);
        is_there = memcmp(data + byte_count - sizeof wanted, &wanted, sizeof wanted) == 0;
    }
    free(data);
    return is_there;
}

/* Tells whether the file of a shared library is complete. The linker writes its table of sections last. */
static bool is_library_complete(const char *data, size_t byte_count)
{
#ifdef __ELF__
    ElfW(Ehdr) head;
    if (byte_count < sizeof head) return false;
    memcpy(&head, data, sizeof head);
    return memcmp(head.e_ident, ELFMAG, SELFMAG) == 0 && head.e_shoff > 0 && head.e_shoff <= byte_count &&
           (size_t)head.e_shnum * head.e_shentsize <= byte_count - head.e_shoff;
#else
    (void)data;
    return byte_count > 0;
#endif
}

/* Appends the seal to a complete library. Returns false if it is not complete. */
static bool append_seal(const char *path, const compilation_key *key)
{
    size_t byte_count = 0;
    char *data = tvi_file_restrict_to_user(path) ? tvi_file_read(path, &byte_count) : NULL;
    const bool serves = data && is_library_complete(data, byte_count);
    const cache_seal s = compute_seal(key, data, serves ? byte_count : 0);
    free(data);
    return serves && tvi_file_write(path, true, &s, sizeof s);
}

/* ---- The compiler ------------------------------------------------------------------------------------------------ */

enum { MAX_WORDS = 128 };

/* Splits a text at its blanks, and appends the words to an array. Returns false if there are too many words. */
static bool split_into_words(char *text, char *words[], int *count)
{
    for (char *at = text; *at;) {
        at += strspn(at, " \t\n");
        if (!*at) break;
        if (*count == MAX_WORDS) return false;
        words[(*count)++] = at;
        at += strcspn(at, " \t\n");
        if (*at) *at++ = 0;
    }
    return true;
}

/* Refuses with TVI_ECOMPILE. The text is the first line of the compiler's output that contains "error", otherwise
 * the first line. */
static tvi_status refuse_with_compiler_output(const char *compiler, const char *output_path)
{
    size_t byte_count = 0;
    char *output = tvi_file_read(output_path, &byte_count);
    const char *named = output ? strstr(output, "error") : NULL, *line = output ? output : "";
    while (named && named > output && named[-1] != '\n') named--;
    if (named) line = named;
    const tvi_status status = jet_refuse(TVI_ECOMPILE, "%s failed: %.*s", compiler, (int)strcspn(line, "\n"), line);
    free(output);
    return status;
}

static tvi_status run_compiler(const compilation_request *request, const compilation_files *files)
{
    char *words[MAX_WORDS + LAST_ARGUMENTS + 4];
    int count = 0;
    jet_text text = {0};
    jet_text_append(&text, "%s %s", request->compiler_command, request->flags);
    bool is_split = !text.is_incomplete && split_into_words(text.data, words, &count) && count > 0;
    char *const file_arguments[] = {"-o", files->library.data, files->source.data};
    memcpy(words + count, file_arguments, sizeof file_arguments);
    memcpy(words + count + 3, last_arguments, sizeof last_arguments);
    words[count + 3 + LAST_ARGUMENTS] = NULL;
    const int failed = is_split ? tvi_process_run(words, files->output.data) : -1;
    free(text.data);
    if (failed < 0) return jet_refuse(TVI_ECOMPILE, "%s could not be started", request->compiler_command);
    return failed > 0 ? refuse_with_compiler_output(request->compiler_command, files->output.data) : TVI_OK;
}

/* Writes the source and compiles it. The library gets its seal for the cache. */
static tvi_status compile_library(const compilation_request *request, const compilation_files *files,
                                  const jet_text *text)
{
    if (!tvi_file_write(files->source.data, false, text->data, text->length))
        return jet_refuse(TVI_ECOMPILE, "%s cannot be written", files->source.data);
    const tvi_status status = run_compiler(request, files);
    if (status != TVI_OK || append_seal(files->library.data, &request->key)) return status;
    return jet_refuse(TVI_ECOMPILE, "%s made no library, or not all of it", request->compiler_command);
}

/* ---- Loading ----------------------------------------------------------------------------------------------------- */

typedef const tvi_compiled *generated_fn(void);

static tvi_status open_library(tvi_compiled **out, const char *path)
{
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    generated_fn *generated = NULL;
    if (library) *(void **)&generated = dlsym(library, TVI_COMPILED_NAME);
    if (!generated) {
        const tvi_status status = jet_refuse(TVI_ECOMPILE, "the generated code cannot be loaded: %s", dlerror());
        if (library) dlclose(library);
        return status;
    }
    *out = malloc(sizeof **out);
    if (*out) **out = (tvi_compiled){generated()->code, library, 1};
    else dlclose(library);
    return *out ? TVI_OK : TVI_ENOMEM;
}

/* Compiles the library, opens it, and moves it to the cache. A library that cannot be opened is not stored. */
static tvi_status compile_and_open(tvi_compiled **out, const compilation_request *request,
                                   const compilation_files *files, const jet_text *text, const char *cached_path)
{
    tvi_status status = compile_library(request, files, text);
    if (status != TVI_OK) return status;
    status = open_library(out, files->library.data);
    if (status != TVI_OK || !request->uses_cache || tvi_file_move(files->library.data, cached_path)) return status;
    tvi_compiled_free(*out);
    *out = NULL;
    return jet_refuse(TVI_ECOMPILE, "%s cannot be written", cached_path);
}

static tvi_status compile_in_temporary_directory(tvi_compiled **out, const compilation_request *request,
                                                 const jet_text *text, const char *cached_path)
{
    compilation_files files = {.temporary_directory = {0}};
    tvi_status status;
    jet_text_append(&files.temporary_directory, "%s/make-XXXXXX", request->cache_or_temporary_directory.data);
    if (files.temporary_directory.is_incomplete) return TVI_ENOMEM;
    if (!tvi_directory_create_temporary(files.temporary_directory.data)) {
        status = jet_refuse(TVI_ECOMPILE, "nothing can be written to %s", request->cache_or_temporary_directory.data);
        free(files.temporary_directory.data);
        return status;
    }
    jet_text_append(&files.source, "%s/tvi.c", files.temporary_directory.data);
    jet_text_append(&files.library, "%s/tvi.so", files.temporary_directory.data);
    jet_text_append(&files.output, "%s/output", files.temporary_directory.data);
    const bool failed = files.source.is_incomplete || files.library.is_incomplete || files.output.is_incomplete;
    status = failed ? TVI_ENOMEM : compile_and_open(out, request, &files, text, cached_path);
    const char *const to_remove[] = {files.source.data, files.library.data, files.output.data, NULL};
    tvi_directory_remove(files.temporary_directory.data, to_remove);
    free(files.temporary_directory.data);
    free(files.source.data);
    free(files.library.data);
    free(files.output.data);
    return status;
}

static tvi_status load_from_cache_or_compile(tvi_compiled **out, const compilation_request *request,
                                             const jet_text *text)
{
    jet_text cached_path = {0};
    if (request->uses_cache && !tvi_directory_create_private(request->cache_or_temporary_directory.data))
        return jet_refuse(TVI_ECOMPILE,
                          "%s cannot be made, or is not a directory of your own with the mode 0700: run chmod 700, or "
                          "name another cache",
                          request->cache_or_temporary_directory.data);
    jet_text_append(&cached_path, "%s/%016" PRIx64 "%016" PRIx64 ".so", request->cache_or_temporary_directory.data,
                    request->key.hash[0], request->key.hash[1]);
    if (cached_path.is_incomplete) return TVI_ENOMEM;
    const bool is_there = request->uses_cache && has_valid_seal(cached_path.data, &request->key);
    const tvi_status status = is_there ? open_library(out, cached_path.data)
                                       : compile_in_temporary_directory(out, request, text, cached_path.data);
    free(cached_path.data);
    return status;
}

tvi_status tvi_compiled_load_or_compile(tvi_compiled **out, const jet_text *text, const tvi_compiler *compiler,
                                        jet_isa isa)
{
    compilation_request request = make_compilation_request(text, compiler, isa);
    const tvi_status status = request.cache_or_temporary_directory.is_incomplete
                                  ? TVI_ENOMEM
                                  : load_from_cache_or_compile(out, &request, text);
    free(request.cache_or_temporary_directory.data);
    return status;
}
