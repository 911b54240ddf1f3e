/* test_owners.c - Tests who owns generated code, and whom it serves. */
#define _XOPEN_SOURCE 700
#include "compiled.h"
#include "problems/texts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static tvi_options options_of(const char *name, int order)
{
    tvi_options options;
    ck_assert_int_eq(tvi_options_named(name, order, &options), TVI_OK);
    return options;
}

static tvi_system *system_of(const scene *s)
{
    tvi_system *system;
    ck_assert_int_eq(scene_system(s, &system), TVI_OK);
    return system;
}

/* Freed by its maker, the code runs on as long as an integrator has it. */
START_TEST(an_integrator_keeps_its_code)
{
    tvi_system *system = system_of(&scene_kepler);
    tvi_options options = tvi_options_default();
    tvi_integrator *first, *second;
    tvi_compiled *code;
    motion m = motion_start(&scene_kepler);
    ck_assert_int_eq(tvi_compile(&code, system, &options, &(tvi_compiler){QUICK_COMPILER, QUICK_FLAGS, ""}), TVI_OK);
    options.compiled = code;
    ck_assert_int_eq(tvi_integrator_create(&first, system, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&second, system, &options), TVI_OK);
    tvi_compiled_free(code);
    tvi_integrator_free(first);
    ck_assert_int_eq(tvi_integrate(second, 0.1, 100, &m.t, m.q, m.p, NULL, NULL), TVI_OK);
    double D[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    ck_assert_int_eq(tvi_step_tangent(second, 0.1, &m.t, m.q, m.p, D, 4), TVI_OK);
    ck_assert_int_eq(tvi_integrate_to(second, 0.1, 12.34, &m.t, m.q, m.p, NULL, NULL), TVI_OK);
    ck_assert_double_eq(m.t, 12.34);
    tvi_integrator_free(second);
    tvi_compiled_free(NULL);
    tvi_system_free(system);
}
END_TEST

enum { ANOTHER_SYSTEM, ANOTHER_FORM, ANOTHER_METHOD, ANOTHER_ORDER, ANOTHER_TOLERANCE, THE_SAME, FITS };

START_TEST(code_serves_its_own_system_and_options_alone)
{
    tvi_system *own = system_of(&scene_kepler), *same = system_of(&scene_kepler), *other = system_of(&scene_pendulum);
    tvi_options options = options_of("galerkin", 12);
    tvi_integrator *integrator;
    tvi_compiled *code;
    const tvi_compiler compiler = compiler_of(QUICK);
    const char *why = NULL;
    ck_assert_int_eq(tvi_compile(&code, own, &options, &compiler), TVI_OK);
    if (_i == ANOTHER_METHOD) options = options_of("midpoint", 12);
    if (_i == ANOTHER_ORDER) options.order = 14;
    if (_i == ANOTHER_TOLERANCE) options.tolerance = 1e-9;
    if (_i == ANOTHER_FORM) ck_assert_int_eq(tvi_system_rescaled(&own, same, NULL, NULL), TVI_OK);
    const tvi_system *given = _i == ANOTHER_SYSTEM ? other : _i == ANOTHER_FORM ? own : same;
    options.compiled = code;
    const tvi_status status = _i == THE_SAME ? TVI_OK : TVI_EINVAL;
    ck_assert_int_eq(tvi_options_check(given, &options, &why), status);
    ck_assert(_i == THE_SAME ? why == NULL : why != NULL);
    ck_assert_int_eq(tvi_integrator_create(&integrator, given, &options), status);
    tvi_integrator_free(integrator);
    tvi_compiled_free(code);
}
END_TEST

/* Code for instructions that the tape may not use. The first system has all those of the processor, whatever the
 * environment says. */
START_TEST(code_for_wider_vectors_is_refused)
{
    unsetenv("TVI_ISA");
    tvi_options options = options_of("stormer-verlet", 2);
    tvi_integrator *integrator;
    tvi_compiled *none;
    tvi_system *wide = system_of(&scene_kepler);
    setenv("TVI_ISA", "base", 1);
    tvi_system *narrow = system_of(&scene_kepler);
#if defined(__x86_64__)
    const tvi_compiler native = {.flags = QUICK_FLAGS " -march=native", .cache = ""};
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        tvi_compiled *code;
        ck_assert_int_eq(tvi_compile(&code, wide, &options, &native), TVI_OK);
        options.compiled = code;
        ck_assert_int_eq(tvi_integrator_create(&integrator, narrow, &options), TVI_EINVAL);
        refused("instructions that are not to be used here", tvi_compile(&none, narrow, &options, &native),
                TVI_ECOMPILE);
        tvi_compiled_free(code);
    }
#endif
    ck_assert_int_eq(tvi_compile(&none, narrow, &options, &(tvi_compiler){QUICK_COMPILER, QUICK_FLAGS, ""}), TVI_OK);
    options.compiled = none;
    ck_assert_int_eq(tvi_integrator_create(&integrator, narrow, &options), TVI_OK);
    tvi_integrator_free(integrator);
    ck_assert_int_eq(tvi_integrator_create(&integrator, wide, &options), TVI_OK);
    tvi_integrator_free(integrator);
    tvi_compiled_free(none);
    tvi_system_free(narrow);
    tvi_system_free(wide);
}
END_TEST

/* A state goes on bit for bit with the same code. Its history is dropped by the tape, whose roundoff is another. */
START_TEST(saved_states_go_on)
{
    tvi_system *system = system_of(&scene_solar);
    tvi_options options = options_of("galerkin", 16), plain = options;
    tvi_integrator *integrator, *tape;
    tvi_compiled *code;
    const tvi_compiler compiler = compiler_of(QUICK);
    ck_assert_int_eq(tvi_compile(&code, system, &options, &compiler), TVI_OK);
    options.compiled = code;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    motion m = motion_start(&scene_solar), again;
    ck_assert_int_eq(tvi_integrate(integrator, 400, 10, &m.t, m.q, m.p, NULL, NULL), TVI_OK);
    char *saved = text_of_state(integrator, m.t, m.q, m.p);
    again = m;
    ck_assert_int_eq(tvi_integrate(integrator, 400, 10, &m.t, m.q, m.p, NULL, NULL), TVI_OK);
    tvi_integrator_free(integrator);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    ck_assert_int_eq(tvi_state_from_text(integrator, saved, strlen(saved), &again.t, again.q, again.p), TVI_OK);
    ck_assert_str_eq(tvi_last_error(), "");
    ck_assert(tvi_integrator_stats(integrator)->is_compiled);
    ck_assert_int_eq(tvi_integrate(integrator, 400, 10, &again.t, again.q, again.p, NULL, NULL), TVI_OK);
    ck_assert_mem_eq(&m, &again, sizeof m);
    ck_assert_int_eq(tvi_integrator_create(&tape, system, &plain), TVI_OK);
    ck_assert_int_eq(tvi_state_from_text(tape, saved, strlen(saved), &again.t, again.q, again.p), TVI_OK);
    ck_assert_ptr_nonnull(strstr(tvi_last_error(), "and was dropped"));
    free(saved);
    tvi_integrator_free(tape);
    tvi_integrator_free(integrator);
    tvi_compiled_free(code);
    tvi_system_free(system);
}
END_TEST

START_TEST(arguments_are_checked)
{
    tvi_system *system = system_of(&scene_kepler);
    tvi_options options = options_of("galerkin", 12);
    tvi_compiled *code = (tvi_compiled *)&options;
    refused("out is NULL", tvi_compile(NULL, system, NULL, NULL), TVI_EINVAL);
    refused("system is NULL", tvi_compile(&code, NULL, NULL, NULL), TVI_EINVAL);
    ck_assert_ptr_null(code);
    options.order = 1000;
    refused("order = 1000", tvi_compile(&code, system, &options, NULL), TVI_EINVAL);
    refused("name is NULL", tvi_compiled_write(system, NULL, NULL, "/tmp/never.c"), TVI_EINVAL);
    refused("path is NULL", tvi_compiled_write(system, NULL, "code", NULL), TVI_EINVAL);
    refused("system is NULL", tvi_compiled_write(NULL, NULL, "code", "/tmp/never.c"), TVI_EINVAL);
    refused("/nowhere/never.c cannot be written", tvi_compiled_write(system, NULL, "code", "/nowhere/never.c"),
            TVI_ECOMPILE);
    tvi_system_free(system);
}
END_TEST

Suite *suite_owners(void)
{
    Suite *suite = suite_create("owners");
    TCase *tcase = tcase_create("owners");
    tcase_add_test(tcase, an_integrator_keeps_its_code);
    tcase_add_loop_test(tcase, code_serves_its_own_system_and_options_alone, 0, FITS);
    tcase_add_test(tcase, code_for_wider_vectors_is_refused);
    tcase_add_test(tcase, saved_states_go_on);
    tcase_add_test(tcase, arguments_are_checked);
    suite_add_tcase(suite, tcase);
    return suite;
}
