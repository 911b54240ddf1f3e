/* load.c - Compiles the text of generated code, and loads it. It compiles in a directory of its own, and moves the
 * library to the cache, under a name that hashes all that it was made of. A file in the cache ends with a seal, so that
 * a damaged or foreign file is detected and made anew. */
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

/* The compiler flags of the library's own instruction sets. */
static const char *const flags_of[JET_ISA_COUNT] = {TVI_COMPILED_FLAGS};

/* The arguments after all others. */
static char *const last_words[] = {"-w", "-shared", "-fPIC", TVI_COMPILED_SLEEF "-lm"};
enum { LAST_WORDS = sizeof last_words / sizeof *last_words };

/* The key of a compilation, a hash of 128 bits. */
typedef struct {
    uint64_t hash[2];
} tvi_key;

/* The last bytes of a file in the cache. */
typedef struct {
    char magic[8];
    tvi_key key;
    uint64_t checksum; /* of all bytes before it */
} seal;

/* A request: the compiler and its flags, as the user, the environment or the library gives them. */
typedef struct {
    const char *compiler, *flags;
    /* The directory of the cache, or of temporary files if there is none. */
    jet_text directory;
    bool keeps;
    tvi_key key;
} request;

/* The files of one compilation. */
typedef struct {
    jet_text directory, source, library, output;
} compilation_files;

/* ---- Requests ---------------------------------------------------------------------------------------------------- */

/* Adds a path below a directory, in a form that no compiler takes for an option. */
static void add_below(jet_text *path, const char *directory, const char *below)
{
    jet_text_add(path, "%s%s%s", *directory == '/' ? "" : "./", directory, below);
}

/* A directory of the environment; NULL: there is none, or where it is depends on where the program was started. */
static const char *directory_named(const char *variable)
{
    const char *path = tvi_environment(variable);
    return path && *path == '/' ? path : NULL;
}

static void find_directory(request *r, const char *cache)
{
    const char *home = directory_named("HOME"), *user = directory_named("XDG_CACHE_HOME");
    r->keeps = !cache || *cache;
    if (cache && *cache) add_below(&r->directory, cache, "");
    else if (!r->keeps || (!home && !user)) {
        const char *temporary = tvi_environment("TMPDIR");
        r->keeps = false;
        add_below(&r->directory, temporary ? temporary : "/tmp", "");
    } else if (user) add_below(&r->directory, user, "/tvi");
    else add_below(&r->directory, home, "/.cache/tvi");
}

static void hash(tvi_key *key, const void *data, size_t size)
{
    for (int i = 0; i < 2; i++) key->hash[i] = jet_hash(key->hash[i], data, size);
}

/* Hashes what the flag "native" stands for on this processor. */
static void hash_processor(tvi_key *key)
{
#ifdef JET_ISA_X86
    unsigned id[8] = {0}, of_core;
    __get_cpuid(1, &id[0], &of_core, &id[1], &id[2]);
    __get_cpuid_count(7, 0, &id[3], &id[4], &id[5], &id[6]);
    hash(key, id, sizeof id);
#elif defined(__linux__)
    const unsigned long features[] = {getauxval(AT_HWCAP), getauxval(AT_HWCAP2)};
    hash(key, features, sizeof features);
#else
    (void)key;
#endif
}

static request request_of(const jet_text *text, const tvi_compiler *how, jet_isa isa)
{
    const char *usual = tvi_environment("CC");
    request r = {.compiler = how->compiler ? how->compiler
                             : usual       ? usual
                                           : "cc",
                 .flags = how->flags ? how->flags : flags_of[isa],
                 .key = {{JET_HASH_OF_NOTHING, ~JET_HASH_OF_NOTHING}}};
    find_directory(&r, how->cache);
    hash(&r.key, text->data, text->size);
    hash(&r.key, r.compiler, strlen(r.compiler) + 1);
    hash(&r.key, r.flags, strlen(r.flags) + 1);
    for (int i = 0; i < LAST_WORDS; i++) hash(&r.key, last_words[i], strlen(last_words[i]) + 1);
    hash_processor(&r.key);
    return r;
}

/* ---- Seals ------------------------------------------------------------------------------------------------------- */

static seal seal_of(const tvi_key *key, const char *data, size_t size)
{
    return (seal){{'t', 'v', 'i', ' ', 'c', 'o', 'd', 'e'}, *key, jet_hash(JET_HASH_OF_NOTHING, data, size)};
}

static bool is_sealed(const char *path, const tvi_key *key)
{
    size_t size;
    char *data = tvi_file_read(path, &size);
    bool is_there = false;
    if (data && size > sizeof(seal)) {
        const seal wanted = seal_of(key, data, size - sizeof wanted);
        is_there = memcmp(data + size - sizeof wanted, &wanted, sizeof wanted) == 0;
    }
    free(data);
    return is_there;
}

/* Tells whether a library is complete: its table of sections is what the linker writes last. */
static bool is_whole(const char *data, size_t size)
{
#ifdef __ELF__
    ElfW(Ehdr) head;
    if (size < sizeof head) return false;
    memcpy(&head, data, sizeof head);
    return memcmp(head.e_ident, ELFMAG, SELFMAG) == 0 && head.e_shoff > 0 && head.e_shoff <= size &&
           (size_t)head.e_shnum * head.e_shentsize <= size - head.e_shoff;
#else
    (void)data;
    return size > 0;
#endif
}

static bool put_seal(const char *path, const tvi_key *key)
{
    size_t size = 0;
    char *data = tvi_file_claim(path) ? tvi_file_read(path, &size) : NULL;
    const bool serves = data && is_whole(data, size);
    const seal s = seal_of(key, data, serves ? size : 0);
    free(data);
    return serves && tvi_file_append(path, &s, sizeof s);
}

/* ---- The compiler ------------------------------------------------------------------------------------------------ */

enum { WORDS_MOST = 128 };

/* Splits a text at its blanks. Returns false if there are too many words. */
static bool add_words(char *text, char *words[], int *count)
{
    for (char *at = text; *at;) {
        at += strspn(at, " \t\n");
        if (!*at) break;
        if (*count == WORDS_MOST) return false;
        words[(*count)++] = at;
        at += strcspn(at, " \t\n");
        if (*at) *at++ = 0;
    }
    return true;
}

/* Refuses with the first line of the compiler's output that names an error, or with the first line. */
static tvi_status quote_output(const char *compiler, const char *path)
{
    size_t size = 0;
    char *output = tvi_file_read(path, &size);
    const char *named = output ? strstr(output, "error") : NULL, *line = output ? output : "";
    while (named && named > output && named[-1] != '\n') named--;
    if (named) line = named;
    const tvi_status status = jet_refuse(TVI_ECOMPILE, "%s failed: %.*s", compiler, (int)strcspn(line, "\n"), line);
    free(output);
    return status;
}

static tvi_status run_compiler(const request *r, const compilation_files *w)
{
    char *words[WORDS_MOST + LAST_WORDS + 4];
    int count = 0;
    jet_text text = {0};
    jet_text_add(&text, "%s %s", r->compiler, r->flags);
    bool is_split = !text.failed && add_words(text.data, words, &count) && count > 0;
    char *const files[] = {"-o", w->library.data, w->source.data};
    memcpy(words + count, files, sizeof files);
    memcpy(words + count + 3, last_words, sizeof last_words);
    words[count + 3 + LAST_WORDS] = NULL;
    const int failed = is_split ? tvi_process_run(words, w->output.data) : -1;
    free(text.data);
    if (failed < 0) return jet_refuse(TVI_ECOMPILE, "%s could not be started", r->compiler);
    return failed > 0 ? quote_output(r->compiler, w->output.data) : TVI_OK;
}

/* Writes the source and compiles it. A library for the cache gets its seal. */
static tvi_status make_library(const request *r, const compilation_files *w, const jet_text *text)
{
    if (!tvi_file_write(w->source.data, text->data, text->size))
        return jet_refuse(TVI_ECOMPILE, "%s cannot be written", w->source.data);
    const tvi_status status = run_compiler(r, w);
    if (status != TVI_OK || put_seal(w->library.data, &r->key)) return status;
    return jet_refuse(TVI_ECOMPILE, "%s made no library, or not all of it", r->compiler);
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

/* Compiles the library and opens it. One that cannot be loaded is not kept. */
static tvi_status compile_and_open(tvi_compiled **out, const request *r, const compilation_files *w,
                                   const jet_text *text, const char *kept)
{
    tvi_status status = make_library(r, w, text);
    if (status != TVI_OK) return status;
    status = open_library(out, w->library.data);
    if (status != TVI_OK || !r->keeps || tvi_file_move(w->library.data, kept)) return status;
    tvi_compiled_free(*out);
    *out = NULL;
    return jet_refuse(TVI_ECOMPILE, "%s cannot be written", kept);
}

static tvi_status make_and_open(tvi_compiled **out, const request *r, const jet_text *text, const char *kept)
{
    compilation_files w = {.directory = {0}};
    tvi_status status;
    jet_text_add(&w.directory, "%s/make-XXXXXX", r->directory.data);
    if (w.directory.failed) return TVI_ENOMEM;
    if (!tvi_directory_own(w.directory.data)) {
        status = jet_refuse(TVI_ECOMPILE, "nothing can be written to %s, or others may exchange it", r->directory.data);
        free(w.directory.data);
        return status;
    }
    jet_text_add(&w.source, "%s/tvi.c", w.directory.data);
    jet_text_add(&w.library, "%s/tvi.so", w.directory.data);
    jet_text_add(&w.output, "%s/output", w.directory.data);
    const bool failed = w.source.failed || w.library.failed || w.output.failed;
    status = failed ? TVI_ENOMEM : compile_and_open(out, r, &w, text, kept);
    const char *const files[] = {w.source.data, w.library.data, w.output.data, NULL};
    tvi_directory_remove(w.directory.data, files);
    free(w.directory.data);
    free(w.source.data);
    free(w.library.data);
    free(w.output.data);
    return status;
}

static tvi_status find_or_make(tvi_compiled **out, const request *r, const jet_text *text)
{
    jet_text kept = {0};
    if (r->keeps && !tvi_directory_make(r->directory.data))
        return jet_refuse(TVI_ECOMPILE,
                          "%s is not a directory of the user's own that no other may write to or exchange",
                          r->directory.data);
    jet_text_add(&kept, "%s/%016" PRIx64 "%016" PRIx64 ".so", r->directory.data, r->key.hash[0], r->key.hash[1]);
    if (kept.failed) return TVI_ENOMEM;
    const bool is_there = r->keeps && is_sealed(kept.data, &r->key);
    const tvi_status status = is_there ? open_library(out, kept.data) : make_and_open(out, r, text, kept.data);
    free(kept.data);
    return status;
}

tvi_status tvi_compiled_load(tvi_compiled **out, const jet_text *text, const tvi_compiler *how, jet_isa isa)
{
    request r = request_of(text, how, isa);
    const tvi_status status = r.directory.failed ? TVI_ENOMEM : find_or_make(out, &r, text);
    free(r.directory.data);
    return status;
}
