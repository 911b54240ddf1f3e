/* test_locales.c - Tests that all texts of the library are the same in every locale: generated code, states and
 * refusals. The locales write the decimal point as a comma or as two bytes; localedef makes them for the test. */
#define _XOPEN_SOURCE 700
#include "compiled.h"

#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const locales[] = {"de_DE", "ps_AF"};
enum { LOCALES = sizeof locales / sizeof *locales, MOST = 1 << 20 };

static const char *folder;

static void make_locale(const char *name)
{
    char command[200], number[20];
    folder = directory_make();
    snprintf(command, sizeof command, "localedef -i %s -f UTF-8 %s/%s.UTF-8 >%s/log 2>&1", name, folder, name, folder);
    ck_assert_msg(system(command) == 0, "%s", command);
    setenv("LOCPATH", folder, 1);
    snprintf(command, sizeof command, "%s.UTF-8", name);
    ck_assert_ptr_nonnull(setlocale(LC_ALL, command));
    snprintf(number, sizeof number, "%.1f", 0.5);
    ck_assert_str_ne(number, "0.5");
}

static tvi_system *kepler(void)
{
    tvi_system *system;
    ck_assert_int_eq(scene_system(&scene_kepler, &system), TVI_OK);
    return system;
}

/* ---- The texts --------------------------------------------------------------------------------------------------- */

/* The arguments of the functions below, each of which returns a text that lasts until its next call. */
typedef struct {
    tvi_system *system;
    tvi_integrator *integrator;
    tvi_ensemble *ensemble;
    motion m;
} owner;

static const char *code(const owner *o, const char *method, int order)
{
    static char text[MOST];
    char path[200];
    tvi_options options;
    ck_assert_int_eq(tvi_options_named(method, order, &options), TVI_OK);
    snprintf(path, sizeof path, "%s/code.c", folder);
    ck_assert_int_eq(tvi_compiled_write(o->system, &options, "code", path), TVI_OK);
    FILE *file = fopen(path, "r");
    const size_t size = fread(text, 1, sizeof text - 1, file);
    ck_assert(size > 0 && size < sizeof text - 1);
    text[size] = 0;
    fclose(file);
    return text;
}

static const char *code_of_galerkin(const owner *o) { return code(o, "galerkin", 12); }
static const char *code_of_curve(const owner *o) { return code(o, "midpoint", 8); }

static char state[4000];
static const char *state_of_integrator(const owner *o)
{
    size_t size = sizeof state - 1;
    ck_assert_int_eq(tvi_state_to_text(o->integrator, o->m.t, o->m.q, o->m.p, state, &size), TVI_OK);
    state[size] = 0;
    return state;
}

static const char *state_of_member(const owner *o)
{
    size_t size = sizeof state - 1;
    ck_assert_int_eq(tvi_ensemble_member_to_text(o->ensemble, 0, &o->m.t, o->m.q, o->m.p, state, &size), TVI_OK);
    state[size] = 0;
    return state;
}

/* Reads the state that was written, and writes it again. */
static const char *state_again(const owner *o)
{
    owner again = *o;
    const char *text = state_of_integrator(o);
    ck_assert_int_eq(tvi_state_from_text(again.integrator, text, strlen(text), &again.m.t, again.m.q, again.m.p),
                     TVI_OK);
    ck_assert_mem_eq(&again.m, &o->m, sizeof again.m);
    return state_of_integrator(&again);
}

static jet log_of_q(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_log(q[0]);
}

static const char *mass(const owner *o)
{
    tvi_system *system;
    (void)o;
    ck_assert_int_eq(tvi_system_potential(&system, 1, (const double[]){-1.5}, log_of_q, NULL), TVI_EINVAL);
    return tvi_last_error();
}

static const char *domain(const owner *o)
{
    tvi_system *system;
    double H;
    (void)o;
    ck_assert_int_eq(tvi_system_potential(&system, 1, NULL, log_of_q, NULL), TVI_OK);
    ck_assert_int_eq(tvi_energy(system, 0, (const double[]){-0.25}, (const double[]){0}, &H), TVI_EDOMAIN);
    tvi_system_free(system);
    return tvi_last_error();
}

static const char *times(const owner *o)
{
    motion m = o->m;
    const tvi_status status =
        tvi_integrate_at(o->integrator, 0.1, (const double[]){1e3, 0.5}, 2, &m.t, m.q, m.p, NULL, NULL);
    ck_assert_int_eq(status, TVI_EINVAL);
    return tvi_last_error();
}

static const char *step(const owner *o)
{
    motion m = o->m;
    ck_assert_int_ne(tvi_step(o->integrator, 12.5, &m.t, m.q, m.p), TVI_OK);
    return tvi_last_error();
}

static const char *theta(const owner *o)
{
    motion m = o->m;
    ck_assert_int_eq(tvi_step(o->integrator, 0.01, &m.t, m.q, m.p), TVI_OK);
    ck_assert_int_eq(tvi_dense(o->integrator, 1.5, m.q, m.p), TVI_EINVAL);
    return tvi_last_error();
}

typedef const char *text_fn(const owner *);
static text_fn *const texts[] = {code_of_galerkin,
                                 code_of_curve,
                                 state_of_integrator,
                                 state_of_member,
                                 state_again,
                                 mass,
                                 domain,
                                 times,
                                 step,
                                 theta};
enum { TEXTS = sizeof texts / sizeof *texts };

static owner owner_open(void)
{
    owner o = {.system = kepler(), .m = motion_start(&scene_kepler)};
    ck_assert_int_eq(tvi_integrator_create(&o.integrator, o.system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_ensemble_create(&o.ensemble, o.system, NULL, 1, 1), TVI_OK);
    ck_assert_int_eq(tvi_step(o.integrator, 0.01, &o.m.t, o.m.q, o.m.p), TVI_OK);
    return o;
}

static void owner_close(const owner *o)
{
    tvi_ensemble_free(o->ensemble);
    tvi_integrator_free(o->integrator);
    tvi_system_free(o->system);
}

START_TEST(texts_are_the_same)
{
    static char wanted[MOST];
    const owner before = owner_open();
    folder = directory_make();
    strcpy(wanted, texts[_i / LOCALES](&before));
    ck_assert_ptr_nonnull(strchr(wanted, '.'));
    owner_close(&before);
    make_locale(locales[_i % LOCALES]);
    const owner in_locale = owner_open();
    const char *text = texts[_i / LOCALES](&in_locale);
    size_t same = 0;
    while (text[same] && text[same] == wanted[same]) same++;
    ck_assert_msg(text[same] == wanted[same], "%.40s, not %.40s", text + same, wanted + same);
    owner_close(&in_locale);
}
END_TEST

START_TEST(code_compiles_and_runs)
{
    make_locale(locales[_i]);
    tvi_system *system = kepler();
    tvi_options options = tvi_options_default();
    motion tape = motion_start(&scene_kepler), compiled = tape;
    tvi_stats stats;
    tvi_compiled *made;
    ck_assert_int_eq(motion_go(system, &options, 0.01, 10, &tape, &stats), TVI_OK);
    const tvi_compiler compiler = {QUICK_COMPILER, QUICK_FLAGS, ""};
    ck_assert_msg(tvi_compile(&made, system, &options, &compiler) == TVI_OK, "%s", tvi_last_error());
    options.compiled = made;
    ck_assert_int_eq(motion_go(system, &options, 0.01, 10, &compiled, &stats), TVI_OK);
    ck_assert_double_le(motion_difference(2, &tape, &compiled), 1e-14);
    tvi_compiled_free(made);
    tvi_system_free(system);
}
END_TEST

Suite *suite_locales(void)
{
    Suite *suite = suite_create("locales");
    TCase *tcase = tcase_create("locales");
    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, texts_are_the_same, 0, TEXTS * LOCALES);
    tcase_add_loop_test(tcase, code_compiles_and_runs, 0, LOCALES);
    suite_add_tcase(suite, tcase);
    return suite;
}
