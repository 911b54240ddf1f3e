/* test_names.c - Tests the name of the function that a file of generated code defines: any identifier that is no
 * keyword and no name of the library's own, also where the code has the same word for something else. TVI_COMPILED=all
 * tries each word of the code. */
#define _XOPEN_SOURCE 700
#include "compiled.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static tvi_system *system_of(const scene *s)
{
    tvi_system *system;
    ck_assert_int_eq(scene_system(s, &system), TVI_OK);
    return system;
}

static const struct {
    const char *method;
    int order;
    const scene *scene;
} cases[] = {{"galerkin", 8, &scene_kepler},   {"galerkin", 16, &scene_double_pendulum},
             {"galerkin", 8, &scene_vortices}, {"midpoint", 8, &scene_nonseparable},
             {"taylor", 8, &scene_kepler},     {"galerkin", 2, &scene_kepler},
             {"galerkin", 4, &scene_kepler}};
enum { CASES = sizeof cases / sizeof *cases };

/* The path of the file; "" where the name is refused. */
static const char *written(int i, const char *directory, const char *name)
{
    static char path[200];
    tvi_system *system = system_of(cases[i].scene);
    tvi_options options;
    ck_assert_int_eq(tvi_options_named(cases[i].method, cases[i].order, &options), TVI_OK);
    snprintf(path, sizeof path, "%s/%.99s.c", directory, name);
    const tvi_status status = tvi_compiled_write(system, &options, name, path);
    tvi_system_free(system);
    ck_assert_msg(status == TVI_OK || status == TVI_EINVAL, "%s: %s", name, tvi_last_error());
    return status == TVI_OK ? path : "";
}

static void compile(const char *path, const char *name)
{
    char command[300];
    snprintf(command, sizeof command,
             "gcc -std=c11 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -fsyntax-only %s", path);
    ck_assert_msg(*path && system(command) == 0, "%s", name);
}

START_TEST(own_words_are_names_like_any_other)
{
    static const char *const names[] = {"code", "loops", "values", "second", "series", "sums_one", "tail"};
    const char *directory = directory_make();
    for (int i = 0; i < (int)(sizeof names / sizeof *names); i++)
        compile(written(i % CASES, directory, names[i]), names[i]);
    directory_remove(directory);
}
END_TEST

static char *text_of(const char *path)
{
    FILE *file = fopen(path, "r");
    ck_assert_ptr_nonnull(file);
    ck_assert_int_eq(fseek(file, 0, SEEK_END), 0);
    const size_t size = (size_t)ftell(file);
    char *text = calloc(size + 1, 1);
    rewind(file);
    ck_assert_uint_eq(fread(text, 1, size, file), size);
    fclose(file);
    return text;
}

/* The next word, ended with 0; those that were met are remembered. */
static const char *next_word(char **at)
{
    char *begin = *at;
    while (*begin && *begin != '_' && !isalpha((unsigned char)*begin)) begin++;
    char *end = begin;
    while (*end == '_' || isalnum((unsigned char)*end)) end++;
    *at = *end ? end + 1 : end;
    *end = 0;
    return *begin ? begin : NULL;
}

static bool is_new(const char *word)
{
    static char met[1 << 16] = " ";
    char between[120];
    snprintf(between, sizeof between, " %.99s ", word);
    if (strstr(met, between)) return false;
    ck_assert_uint_lt(strlen(met) + strlen(between), sizeof met);
    strcat(met, between + 1);
    return true;
}

/* The names of the C library are the user's to avoid: left out are those of the headers that the code includes, and
 * those in tvi.h, whose macros the code contains. */
static char *text_of_headers(const char *directory, const char *path)
{
    char command[500], headers[200];
    snprintf(headers, sizeof headers, "%s/headers", directory);
    snprintf(command, sizeof command,
             "grep '^#include <' %s | gcc -std=c11 -E -dD -include stdio.h -include stdlib.h -x c - | tr -c "
             "'a-zA-Z0-9_' ' ' >%s",
             path, headers);
    ck_assert_int_eq(system(command), 0);
    return text_of(headers);
}

START_TEST(each_word_of_the_code_is_refused_or_compiles)
{
    const char *directory = directory_make();
    for (int i = 0; i < CASES && runs_all(); i++) {
        const char *code = written(i, directory, "orbit");
        char *text = text_of(code), *headers = text_of_headers(directory, code), *at = text, between[120];
        for (const char *word; (word = next_word(&at));) {
            snprintf(between, sizeof between, " %.99s ", word);
            const bool is_tried = is_new(word) && !strstr(headers, between);
            const char *path = is_tried ? written(i, directory, word) : "";
            if (*path) compile(path, word);
            if (*path) remove(path);
        }
        free(headers);
        free(text);
    }
    directory_remove(directory);
}
END_TEST

START_TEST(other_names_are_refused)
{
    static const struct {
        const char *name, *why;
    } refused[] = {{"", "identifier"},      {"1st", "identifier"},       {"a b", "identifier"}, {"a-b", "identifier"},
                   {"int", "keyword"},      {"thread_local", "keyword"}, {"asm", "keyword"},    {"defined", "keyword"},
                   {"_orbit", "begins"},    {"tvi_orbit", "begins"},     {"jet_run", "begins"}, {"jet", "begins"},
                   {"TVI_orbit", "begins"}, {"JET_run", "begins"},       {"NULL", "macros"},    {"MOVE", "macros"}};
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        ck_assert_str_eq(written(0, "/nowhere", refused[i].name), "");
        ck_assert_ptr_nonnull(strstr(tvi_last_error(), refused[i].why));
    }
}
END_TEST

/* Also words of C++, and names of the C library that the code has no use for. */
START_TEST(all_others_are_allowed)
{
    static const char *const allowed[] = {"orbit",   "f",           "sqrtx",    "class",    "final",
                                          "and",     "read",        "err",      "timespec", "always_inline",
                                          "aligned", "vector_size", "optimize", "once",     "unroll"};
    const char *directory = directory_make();
    for (int i = 0; i < (int)(sizeof allowed / sizeof *allowed); i++)
        compile(written(i % CASES, directory, allowed[i]), allowed[i]);
    directory_remove(directory);
}
END_TEST

Suite *suite_names(void)
{
    Suite *suite = suite_create("names");
    TCase *tcase = tcase_create("names");
    tcase_add_test(tcase, own_words_are_names_like_any_other);
    tcase_add_test(tcase, each_word_of_the_code_is_refused_or_compiles);
    tcase_add_test(tcase, other_names_are_refused);
    tcase_add_test(tcase, all_others_are_allowed);
    suite_add_tcase(suite, tcase);
    return suite;
}
