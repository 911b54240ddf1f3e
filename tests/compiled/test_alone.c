/* Generated text alone, read by gcc and by clang with all warnings, for the base instructions and those with wider
 * vectors: no macro, function or type is missing, and none stands there twice, for any method, order and form. */
#include "compiled.h"
#include "method/list.h"

#include <stdio.h>
#include <stdlib.h>

static const whose separable = {&scene_kepler, 0, false, NULL}, lagrangian = {&scene_double_pendulum, 0, false, NULL},
                   hamiltonian = {&scene_nonseparable, 0, false, NULL}, rescaled = {&scene_kepler, 0, true, NULL},
                   large = {&scene_solar, 0, false, NULL};
static const whose *const forms[] = {&separable, &lagrangian, &hamiltonian, &rescaled, &large};

static const char *const compilers[] = {"gcc", "clang"};
static const char *const instructions[] = {
    "",
#ifdef __x86_64__
    "-mavx2 -mfma",
    "-mavx2 -mfma -mavx512f -mavx512dq -mavx512vl -mprefer-vector-width=512",
    "-DJET_SLEEF",
#endif
};
enum {
    FORMS = sizeof forms / sizeof *forms,
    COMPILERS = sizeof compilers / sizeof *compilers,
    INSTRUCTIONS = sizeof instructions / sizeof *instructions,
    DEGREES = 12
};

static void read_alone(const char *directory, const char *compiler, const char *flags, const char *title, int degree)
{
    char command[400];
    snprintf(command, sizeof command,
             "%s %s -std=c11 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -fsyntax-only %s/orbit.c", compiler,
             flags, directory);
    ck_assert_msg(system(command) == 0, "%s, degree %d: %s", title, degree, command);
}

/* Writes what the method has of the system; false where it does not serve it. */
static bool write_text(const char *directory, const whose *subject, const tvi_options *options)
{
    char path[128];
    systems its;
    const tvi_system *system = systems_open(subject, &its);
    const bool serves = tvi_options_check(system, options, NULL) == TVI_OK;
    snprintf(path, sizeof path, "%s/orbit.c", directory);
    if (serves) ck_assert_msg(tvi_compiled_write(system, options, "orbit", path) == TVI_OK, "%s", tvi_last_error());
    systems_free(&its);
    return serves;
}

/* Compilers, instructions and degrees in turns; with TVI_COMPILED=all all degrees with all forms. */
START_TEST(the_text_is_whole)
{
    const char *directory = directory_make();
    const tvi_descriptor *method = tvi_methods[_i];
    int turn = 7 * _i, texts = 0;
    for (int nodes = TVI_NODES_ON_CURVE; nodes <= TVI_NODES_TRUNCATED; nodes++)
        for (int first = 0, done = 0; first < DEGREES * FORMS && (runs_all() || done == 0); first++) {
            const int degree = 1 + (first + turn) % DEGREES;
            const tvi_options options = {
                .method = method->method, .expansion = method->expansion, .nodes = (tvi_nodes)nodes, .degree = degree};
            if (!write_text(directory, forms[(first / DEGREES + turn) % FORMS], &options)) continue;
            read_alone(directory, compilers[turn % COMPILERS], instructions[turn / COMPILERS % INSTRUCTIONS],
                       method->title, degree);
            turn++, done++, texts++;
        }
    ck_assert_msg(texts > 0, "%s: no text was written", method->title);
    directory_remove(directory);
}
END_TEST

Suite *suite_alone(void)
{
    Suite *suite = suite_create("alone");
    TCase *tcase = tcase_create("alone");
    int count = 0;
    while (tvi_methods[count]) count++;
    tcase_set_timeout(tcase, runs_all() ? 600 : 60);
    tcase_add_loop_test(tcase, the_text_is_whole, 0, count);
    suite_add_tcase(suite, tcase);
    return suite;
}
