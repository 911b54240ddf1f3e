/* test_cache.c - Tests what may go wrong on the way to generated code: each time a status, and never another's code or
 * half of one. */
#define _XOPEN_SOURCE 700
#include "compiled.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static tvi_system *system_of(const scene *s)
{
    tvi_system *system;
    ck_assert_int_eq(scene_system(s, &system), TVI_OK);
    return system;
}

/* Compiles the scene with the method that compiles soonest; with code, whether it moves as the tape does. */
static tvi_status try(const scene *s, const tvi_compiler *how)
{
    tvi_system *system = system_of(s);
    tvi_options options;
    tvi_compiled *code;
    ck_assert_int_eq(tvi_options_named("stormer-verlet", 2, &options), TVI_OK);
    const tvi_status status = tvi_compile(&code, system, &options, how);
    ck_assert(status == TVI_OK ? code != NULL : code == NULL);
    for (int compiled = 0; compiled < 2 && code; compiled++) {
        static motion m[2];
        tvi_integrator *integrator;
        options.compiled = compiled ? code : NULL;
        m[compiled] = motion_start(s);
        ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
        ck_assert_int_eq(tvi_integrate(integrator, 0.1, 5, &m[compiled].t, m[compiled].q, m[compiled].p, NULL, NULL),
                         TVI_OK);
        tvi_integrator_free(integrator);
        if (compiled) ck_assert_double_lt(motion_difference(s->n, &m[0], &m[1]), 1e-13);
    }
    tvi_compiled_free(code);
    tvi_system_free(system);
    return status;
}

/* AGAIN compiles nothing twice. It serves tests that need a library, whoever made it. */
#define AGAIN "sh tests/compiled/again.sh cc"

/* ---- Compilers --------------------------------------------------------------------------------------------------- */

static const struct {
    const char *compiler, *flags;
    tvi_status status;
    const char *culprit;
} compilers[] = {
    {"cc", QUICK_FLAGS, TVI_OK, ""},
    {"  cc  -pipe ", " " QUICK_FLAGS " ", TVI_OK, ""},
    {"false", NULL, TVI_ECOMPILE, "false failed"},
    {"true", NULL, TVI_ECOMPILE, "true made no library"},
    {"/nowhere/cc", NULL, TVI_ECOMPILE, "/nowhere/cc could not be started"},
    {"", NULL, TVI_ECOMPILE, "could not be started"},
    {"   ", "", TVI_ECOMPILE, "could not be started"},
    {"cc", "-fno-such-flag", TVI_ECOMPILE, "-fno-such-flag"},
    {"cc", "-include /nowhere.h", TVI_ECOMPILE, "/nowhere.h"},
    {"cc; touch", "$(id) `id` > x", TVI_ECOMPILE, "cc; touch could not be started"}, /* no shell reads it */
    /* its function is not found, which is not kept */
    {"cc", QUICK_FLAGS " -fvisibility=hidden", TVI_ECOMPILE, "the generated code cannot be loaded"},
    {"sh tests/compiled/killed.sh", NULL, TVI_ECOMPILE, "sh tests/compiled/killed.sh failed"},
    {"sh tests/compiled/cut.sh cc", QUICK_FLAGS, TVI_ECOMPILE,
     "sh tests/compiled/cut.sh cc made no library, or not all of it"},
};

START_TEST(a_compiler_that_fails_is_told_of)
{
    const char *cache = directory_make();
    const tvi_compiler how = {compilers[_i].compiler, compilers[_i].flags, cache};
    expect_refusal(how.compiler, try(&scene_kepler, &how), compilers[_i].status, compilers[_i].culprit);
    ck_assert_int_eq(directory_count(cache, ".so"), compilers[_i].status == TVI_OK);
    ck_assert_int_eq(directory_count(cache, ""), compilers[_i].status == TVI_OK);
    directory_remove(cache);
}
END_TEST

START_TEST(the_environment_names_the_compiler)
{
    static const char *const named[] = {"/nowhere/cc", "cc", " \t"}; /* Blanks name no compiler: cc is taken. */
    const char *cache = directory_make();
    for (int i = 0; i < 3; i++) {
        setenv("CC", named[i], 1);
        ck_assert_int_eq(try(&scene_kepler, &(tvi_compiler){NULL, QUICK_FLAGS, cache}), i ? TVI_OK : TVI_ECOMPILE);
    }
    unsetenv("CC");
    directory_remove(cache);
}
END_TEST

/* A process that a compiler leaves behind, as a server, has none of the program's files: nobody writes to a pipe after
 * all ends of it are closed here. */
START_TEST(files_are_the_programs_own)
{
    const char *cache = directory_make();
    int ends[2];
    ck_assert_int_eq(pipe(ends), 0);
    ck_assert_int_eq(try(&scene_kepler, &(tvi_compiler){"sh tests/compiled/server.sh cc", QUICK_FLAGS, cache}), TVI_OK);
    close(ends[1]);
    struct pollfd end = {.fd = ends[0], .events = POLLIN};
    ck_assert_int_eq(poll(&end, 1, 1000), 1);
    ck_assert_int_eq(end.revents, POLLHUP);
    directory_remove(cache);
}
END_TEST

/* ---- Directories ------------------------------------------------------------------------------------------------- */

START_TEST(the_cache_is_where_the_user_keeps_caches)
{
    const char *home = directory_make();
    char path[128];
    const tvi_compiler how = {AGAIN, QUICK_FLAGS, NULL};
    setenv("HOME", home, 1);
    unsetenv("XDG_CACHE_HOME");
    ck_assert_int_eq(try(&scene_kepler, &how), TVI_OK);
    snprintf(path, sizeof path, "%s/.cache/tvi", home);
    ck_assert_int_eq(directory_count(path, ".so"), 1);
    struct stat s;
    ck_assert_int_eq(stat(path, &s), 0);
    ck_assert_int_eq(s.st_mode & 0777, 0700);
    snprintf(path, sizeof path, "%s/elsewhere", home);
    setenv("XDG_CACHE_HOME", path, 1);
    ck_assert_int_eq(try(&scene_kepler, &how), TVI_OK);
    snprintf(path, sizeof path, "%s/elsewhere/tvi", home);
    ck_assert_int_eq(directory_count(path, ".so"), 1);
    directory_remove(home);
}
END_TEST

/* Nor below the working directory, or the root's. */
static const struct {
    const char *cache, *home;
} unkept[] = {{"", "/nowhere"}, {NULL, NULL}, {NULL, ""}, {NULL, "relative"}};
START_TEST(nothing_is_kept_without_a_cache)
{
    const char *top = directory_make();
    const bool was_there = access("/.cache/tvi", F_OK) == 0;
    ck_assert_int_eq(chdir(top), 0);
    unsetenv("HOME");
    if (unkept[_i].home) setenv("HOME", unkept[_i].home, 1);
    setenv("XDG_CACHE_HOME", "relative", 1);
    setenv("TMPDIR", top, 1);
    ck_assert_int_eq(try(&scene_kepler, &(tvi_compiler){"cc", QUICK_FLAGS, unkept[_i].cache}), TVI_OK);
    ck_assert_int_eq(directory_count(top, ""), 0);
    ck_assert_int_eq(access("/.cache/tvi", F_OK) == 0, was_there);
    directory_remove(top);
}
END_TEST

/* Also where the umask gives files away; and what is written stays the user's. */
START_TEST(umasks)
{
    static const mode_t masks[] = {0, 002, 077};
    const char *cache = directory_make();
    umask(masks[_i]);
    for (int again = 0; again < 2; again++)
        ck_assert_int_eq(try(&scene_kepler, &(tvi_compiler){"cc", QUICK_FLAGS, cache}), TVI_OK);
    ck_assert_int_eq(directory_count(cache, ""), 1);
    directory_remove(cache);
}
END_TEST

/* Names that a compiler or a shell could take for something else. */
static const char *const names[] = {"-dir", "@dir", "a b'c\"d", "a;b", "-o", "below/-x", ""};
START_TEST(odd_names)
{
    const char *top = directory_make();
    ck_assert_int_eq(chdir(top), 0);
    for (int again = 0; again < 2; again++)
        ck_assert_int_eq(try(&scene_kepler, &(tvi_compiler){"cc", QUICK_FLAGS, names[_i]}), TVI_OK);
    if (*names[_i]) ck_assert_int_eq(directory_count(names[_i], ".so"), 1);
    directory_remove(top);
}
END_TEST

enum { WRITABLE_BY_OTHERS, OF_ANOTHER, A_LINK, A_FILE, BELOW_A_FILE, NOT_TO_BE_MADE, READ_ONLY, PLACES };

START_TEST(a_directory_that_is_not_the_users_own_to_write_to_is_refused)
{
    const char *top = directory_make();
    char path[128], other[128];
    snprintf(path, sizeof path, "%s/cache", top);
    snprintf(other, sizeof other, "%s/other", top);
    ck_assert_int_eq(mkdir(_i == A_LINK ? other : path, 0700), 0);
    if (_i == WRITABLE_BY_OTHERS) ck_assert_int_eq(chmod(path, 0770), 0);
    if (_i == OF_ANOTHER && chown(path, 12345, 12345) != 0)
        snprintf(path, sizeof path, "/usr"); /* only root gives away */
    if (_i == A_LINK) ck_assert_int_eq(symlink(other, path), 0);
    if (_i == A_FILE || _i == BELOW_A_FILE) {
        ck_assert_int_eq(rmdir(path), 0);
        close(open(path, O_CREAT | O_WRONLY, 0600));
    }
    if (_i == BELOW_A_FILE) strcat(path, "/cache");
    if (_i == NOT_TO_BE_MADE) strcpy(path, "/proc/tvi/cache");
    if (_i == READ_ONLY) snprintf(path, sizeof path, "/proc/%d", (int)getpid()); /* the user's own, also root's */
    const tvi_compiler how = {AGAIN, QUICK_FLAGS, path};
    ck_assert_int_eq(try(&scene_kepler, &how), TVI_ECOMPILE);
    directory_remove(top);
}
END_TEST

/* A directory that is there has to have the mode 0700, by whatever name; nothing is written to another one. */
static const mode_t modes[] = {0700, 0500, 0600, 0710, 0701, 0750, 0755, 0770, 0777};
enum {
    PLAIN_NAME,
    WITH_A_SLASH,
    THROUGH_A_LINK,
    A_LINK_WITH_A_SLASH,
    FROM_WITHIN,
    NAMES,
    MODES = sizeof modes / sizeof *modes
};
START_TEST(a_directory_that_is_there_is_private)
{
    const int name = _i % NAMES;
    const mode_t mode = modes[_i / NAMES];
    const char *top = directory_make();
    char above[128], cache[160], slash[170], link[128], link_to_it[128], link_slash[130];
    snprintf(above, sizeof above, "%s/above", top);
    snprintf(cache, sizeof cache, "%s/cache", above);
    snprintf(slash, sizeof slash, "%s//", cache);
    snprintf(link, sizeof link, "%s/link", top);
    snprintf(link_to_it, sizeof link_to_it, "%s/it", top);
    snprintf(link_slash, sizeof link_slash, "%s/", link_to_it);
    ck_assert(mkdir(above, 0777) == 0 && mkdir(cache, 0700) == 0);
    ck_assert(symlink(above, link) == 0 && symlink(cache, link_to_it) == 0);
    ck_assert_int_eq(chmod(cache, mode), 0);
    if (name == FROM_WITHIN) ck_assert_int_eq(chdir(above), 0);
    const char *const caches[NAMES] = {cache, slash, strcat(link, "/cache"), link_slash, "cache"},
                      *cc = name == FROM_WITHIN ? "cc" : AGAIN;
    const bool serves = mode == 0700 && name != A_LINK_WITH_A_SLASH;
    ck_assert_int_eq(try(&scene_kepler, &(tvi_compiler){cc, QUICK_FLAGS, caches[name]}),
                     serves ? TVI_OK : TVI_ECOMPILE);
    if (!serves) ck_assert_ptr_nonnull(strstr(tvi_last_error(), "0700"));
    ck_assert_int_eq(chmod(cache, 0700), 0);
    ck_assert_int_eq(directory_count(cache, ""), serves ? 1 : 0);
    directory_remove(top);
}
END_TEST

/* Writing ends after some bytes, as on a full disk. */
START_TEST(a_file_that_cannot_be_written_is_refused)
{
    const char *cache = directory_make();
    static const rlim_t sizes[] = {0, 1000};
    const tvi_compiler how = {AGAIN, QUICK_FLAGS, cache};
    const struct rlimit limit = {sizes[_i], sizes[_i]};
    signal(SIGXFSZ, SIG_IGN);
    const int child = fork();
    if (child == 0) {
        setrlimit(RLIMIT_FSIZE, &limit);
        tvi_compiled *code;
        const tvi_status status = tvi_compile(&code, system_of(&scene_kepler), NULL, &how);
        _exit(status == TVI_ECOMPILE && !code ? 0 : 1);
    }
    int status;
    waitpid(child, &status, 0);
    ck_assert_int_eq(status, 0);
    ck_assert_int_eq(directory_count(cache, ""), 0);
    directory_remove(cache);
}
END_TEST

/* ---- What is in the cache ---------------------------------------------------------------------------------------- */

static void find_file(const char *cache, char path[], size_t size)
{
    char command[256];
    snprintf(command, sizeof command, "ls %s/*.so", cache);
    FILE *list = popen(command, "r");
    ck_assert_ptr_nonnull(fgets(path, (int)size, list));
    path[strcspn(path, "\n")] = 0;
    pclose(list);
}

static struct stat state_of(const char *path)
{
    struct stat s;
    ck_assert_int_eq(stat(path, &s), 0);
    return s;
}

/* One file in a cache of its own. */
typedef struct {
    const char *cache;
    tvi_compiler how;
    char path[256];
    struct stat was;
} kept_file;

static kept_file keep_one(void)
{
    kept_file k = {.cache = directory_make()};
    k.how = (tvi_compiler){AGAIN, QUICK_FLAGS, k.cache};
    ck_assert_int_eq(try(&scene_kepler, &k.how), TVI_OK);
    find_file(k.cache, k.path, sizeof k.path);
    k.was = state_of(k.path);
    return k;
}

START_TEST(the_second_time_nothing_is_compiled)
{
    const kept_file k = keep_one();
    ck_assert_int_eq(try(&scene_kepler, &k.how), TVI_OK);
    ck_assert(state_of(k.path).st_ino == k.was.st_ino);
    ck_assert_int_eq(directory_count(k.cache, ""), 1);
    ck_assert_int_eq(try(&scene_pendulum, &k.how), TVI_OK);
    ck_assert_int_eq(directory_count(k.cache, ""), 2);
    directory_remove(k.cache);
}
END_TEST

/* Cut short, a byte changed, longer, empty, another's, open to others, a pipe: what is wrong is made anew. */
enum { CUT, CHANGED, CHANGED_LAST, LONGER, EMPTY, SWAPPED, OPEN, A_PIPE, DAMAGES };

static void damage(const kept_file *k, int how)
{
    const off_t size = k->was.st_size;
    const int file = open(k->path, O_RDWR);
    ck_assert_int_ge(file, 0);
    char byte = 0;
    const off_t at = how == CHANGED_LAST ? size - 1 : size / 2;
    if (how == CUT) ck_assert_int_eq(ftruncate(file, size / 2), 0);
    if (how == EMPTY) ck_assert_int_eq(ftruncate(file, 0), 0);
    if (how == LONGER) ck_assert_int_eq(ftruncate(file, size + 8), 0);
    if (how == OPEN) ck_assert_int_eq(fchmod(file, 0666), 0);
    if (how == CHANGED || how == CHANGED_LAST) {
        ck_assert_int_eq(pread(file, &byte, 1, at), 1);
        byte ^= 1;
        ck_assert_int_eq(pwrite(file, &byte, 1, at), 1);
    }
    close(file);
    if (how == A_PIPE) ck_assert(unlink(k->path) == 0 && mkfifo(k->path, 0600) == 0);
    if (how != SWAPPED) return;
    char command[800], kept[300];
    snprintf(kept, sizeof kept, "%s.kept", k->path);
    ck_assert_int_eq(rename(k->path, kept), 0);
    ck_assert_int_eq(try(&scene_pendulum, &k->how), TVI_OK);
    snprintf(command, sizeof command, "mv %s/*.so %s && rm %s", k->cache, k->path, kept);
    ck_assert_int_eq(system(command), 0);
}

START_TEST(a_damaged_file_is_made_anew)
{
    const kept_file k = keep_one();
    damage(&k, _i);
    ck_assert_int_eq(try(&scene_kepler, &k.how), TVI_OK);
    ck_assert(state_of(k.path).st_ino != k.was.st_ino || _i == SWAPPED || _i == A_PIPE);
    ck_assert_int_eq(directory_count(k.cache, ""), 1);
    directory_remove(k.cache);
}
END_TEST

START_TEST(two_processes_at_once)
{
    enum { PROCESSES = 4 };
    const char *cache = directory_make();
    const tvi_compiler how = {AGAIN, QUICK_FLAGS, cache};
    for (int i = 0; i < PROCESSES; i++)
        if (fork() == 0) _exit(try(&scene_kepler, &how) == TVI_OK ? 0 : 1);
    for (int i = 0; i < PROCESSES; i++) {
        int status;
        wait(&status);
        ck_assert_int_eq(status, 0);
    }
    ck_assert_int_eq(directory_count(cache, ".so"), 1);
    ck_assert_int_eq(directory_count(cache, ""), 1);
    directory_remove(cache);
}
END_TEST

/* Chooses the instruction set whose code is compiled fastest. */
static void pin(void) { setenv("TVI_ISA", "base", 1); }

Suite *suite_cache(void)
{
    Suite *suite = suite_create("cache");
    TCase *tcase = tcase_create("failures");
    tcase_add_checked_fixture(tcase, pin, NULL);
    tcase_add_loop_test(tcase, a_compiler_that_fails_is_told_of, 0, sizeof compilers / sizeof *compilers);
    tcase_add_test(tcase, the_environment_names_the_compiler);
    tcase_add_test(tcase, files_are_the_programs_own);
    tcase_add_loop_test(tcase, umasks, 0, 3);
    tcase_add_loop_test(tcase, odd_names, 0, sizeof names / sizeof *names);
    tcase_add_loop_test(tcase, a_directory_that_is_there_is_private, 0, MODES * NAMES);
    tcase_add_test(tcase, the_cache_is_where_the_user_keeps_caches);
    tcase_add_loop_test(tcase, nothing_is_kept_without_a_cache, 0, sizeof unkept / sizeof *unkept);
    tcase_add_loop_test(tcase, a_directory_that_is_not_the_users_own_to_write_to_is_refused, 0, PLACES);
    tcase_add_loop_test(tcase, a_file_that_cannot_be_written_is_refused, 0, 2);
    tcase_add_test(tcase, the_second_time_nothing_is_compiled);
    tcase_add_loop_test(tcase, a_damaged_file_is_made_anew, 0, DAMAGES);
    tcase_add_test(tcase, two_processes_at_once);
    suite_add_tcase(suite, tcase);
    return suite;
}
