/* test_names.c - Tests the name of the function that a file of generated code defines: any that C and C++ leave to the
 * user, also where the code has the same word for something of its own. TVI_COMPILED=all tries each word of the code.
 */
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

START_TEST(each_word_of_the_code_is_refused_or_compiles)
{
    const char *directory = directory_make();
    for (int i = 0; i < CASES && runs_all(); i++) {
        char *text = text_of(written(i, directory, "orbit")), *at = text;
        for (const char *word; (word = next_word(&at));) {
            const char *path = is_new(word) ? written(i, directory, word) : "";
            if (*path) compile(path, word);
            if (*path) remove(path);
        }
        free(text);
    }
    directory_remove(directory);
}
END_TEST

START_TEST(other_names_are_refused)
{
    static const struct {
        const char *name, *why;
    } refused[] = {
        {"", "identifier"},           {"1st", "identifier"},   {"a b", "identifier"},  {"a-b", "identifier"},
        {"int", "word of C"},         {"class", "word of C"},  {"sqrt", "C library"},  {"main", "C library"},
        {"_orbit", "begins"},         {"tvi_orbit", "begins"}, {"jet_run", "begins"},  {"jet", "begins"},
        {"std", "word of C"},         {"NULL", "macros"},      {"MOVE", "macros"},     {"isnan", "C library"},
        {"fpclassify", "C library"},  {"sinf", "C library"},   {"cexpl", "C library"}, {"int32_t", "C library"},
        {"offsetof", "C library"},    {"strlen", "C library"}, {"read", "C library"},  {"errno", "C library"},
        {"atomic_load", "C library"}, {"va_list", "C library"}};
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        ck_assert_str_eq(written(0, "/nowhere", refused[i].name), "");
        ck_assert_ptr_nonnull(strstr(tvi_last_error(), refused[i].why));
    }
}
END_TEST

/* Names beside those of the C library are the user's. */
START_TEST(names_beside_those_are_allowed)
{
    static const char *const allowed[] = {"orbit", "sinus",     "off",       "f",     "l",    "fl",
                                          "torus", "isosceles", "string_of", "sqrtx", "reads"};
    const char *directory = directory_make();
    for (size_t i = 0; i < sizeof allowed / sizeof *allowed; i++)
        ck_assert_str_ne(written(0, directory, allowed[i]), "");
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
    tcase_add_test(tcase, names_beside_those_are_allowed);
    suite_add_tcase(suite, tcase);
    return suite;
}
