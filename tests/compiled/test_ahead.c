/* test_ahead.c - Tests generated code in a file that is compiled with the program: it compiles without a warning,
 * and serves its system and options alone. */
#define _XOPEN_SOURCE 700
#include "compiled.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *compiler, *method;
    int order;
    const scene *scene;
    double h;
    bool is_wide; /* compiled to all instructions that the library may use here */
} cases[] = {{"gcc -O1", "galerkin", 4, &scene_kepler, 0.1, false},
             {"clang -O2", "midpoint", 6, &scene_kepler, 0.1, true},
             /* with TVI_COMPILED=all */
             {"gcc -O2", "galerkin", 16, &scene_kepler, 0.1, false},
             {"gcc -O1", "tvi", 3, &scene_nonseparable, 0.05, false},
             {"gcc -O3", "galerkin", 10, &scene_double_pendulum, 0.01, true},
             {"clang -O1", "galerkin", 16, &scene_vortices, 0.02, true},
             {"gcc -O1", "galerkin", 2, &scene_kepler, 0.1, false},
             {"gcc -O1", "midpoint", 2, &scene_nonseparable, 0.05, false}};
enum { CASES = sizeof cases / sizeof *cases, FIRST_OF_ALL = 2 };

typedef const tvi_compiled *ahead_fn(void);

/* Builds the code as a program has it that is linked with it. */
static ahead_fn *build(const char *directory, const char *compiler, const char *flags, void **library)
{
    char command[600];
    snprintf(command, sizeof command,
             "%s %s -std=c11 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -shared -fPIC -o %s/orbit.so "
             "%s/orbit.c -lm",
             compiler, flags, directory, directory);
    ck_assert_int_eq(system(command), 0);
    snprintf(command, sizeof command, "%s/orbit.so", directory);
    *library = dlopen(command, RTLD_NOW);
    ck_assert_msg(*library != NULL, "%s", dlerror());
    ahead_fn *orbit;
    *(void **)&orbit = dlsym(*library, "orbit");
    ck_assert(orbit != NULL);
    return orbit;
}

static motion move(const scene *s, const tvi_system *system, const tvi_options *options, double h)
{
    motion m = motion_start(s);
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, options), TVI_OK);
    ck_assert_int_eq(tvi_integrate(integrator, h, 10, &m.t, m.q, m.p, NULL, NULL), TVI_OK);
    ck_assert(tvi_integrator_stats(integrator)->is_compiled == (options->compiled != NULL));
    tvi_integrator_free(integrator);
    return m;
}

START_TEST(a_file_is_compiled_with_the_program)
{
    const scene *s = cases[_i].scene;
    const char *directory = directory_make();
    char path[128];
    tvi_system *system, *other;
    tvi_options options;
    tvi_integrator *none;
    void *library;
    ck_assert_int_eq(scene_system(s, &system), TVI_OK);
    ck_assert_int_eq(scene_system(&scene_pendulum, &other), TVI_OK);
    ck_assert_int_eq(tvi_options_named(cases[_i].method, cases[_i].order, &options), TVI_OK);
    snprintf(path, sizeof path, "%s/orbit.c", directory);
    ck_assert_int_eq(tvi_compiled_write(system, &options, "orbit", path), TVI_OK);
    const char *flags = cases[_i].is_wide ? instructions_flag() : "";
    const tvi_compiled *code = build(directory, cases[_i].compiler, flags, &library)();
    const motion of_tape = move(s, system, &options, cases[_i].h);
    options.compiled = code;
    const motion of_code = move(s, system, &options, cases[_i].h);
    ck_assert_double_lt(motion_difference(s->n, &of_tape, &of_code), 1e-12);
    ck_assert_int_eq(tvi_integrator_create(&none, other, &options), TVI_EINVAL);
    ck_assert_msg(strstr(tvi_last_error(), "another system") != NULL, "%s", tvi_last_error());
    tvi_compiled_free((tvi_compiled *)code); /* is nobody's */
    dlclose(library);
    directory_remove(directory);
    tvi_system_free(other);
    tvi_system_free(system);
}
END_TEST

Suite *suite_ahead(void)
{
    Suite *suite = suite_create("ahead");
    TCase *tcase = tcase_create("files");
    tcase_add_loop_test(tcase, a_file_is_compiled_with_the_program, 0, runs_all() ? CASES : FIRST_OF_ALL);
    suite_add_tcase(suite, tcase);
    return suite;
}
