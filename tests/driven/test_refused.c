/* test_refused.c - Tests systems that cannot be driven, and methods that do not serve those that are. */
#include "driven.h"
#include "problems/refusals.h"

static void no_potential(const jet q[], jet t, jet force[], void *ctx)
{
    (void)t, (void)ctx;
    force[0] = jet_neg(q[0]);
}

static jet scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_exp(q[0]);
}

static tvi_status make_force(tvi_system **base) { return tvi_system_force(base, 1, NULL, no_potential, NULL); }

static tvi_status make_rescaled(tvi_system **base)
{
    tvi_system *plain;
    tvi_status status = forms[0].make(&plain);
    if (status == TVI_OK) status = tvi_system_rescaled(base, plain, scale, NULL);
    tvi_system_free(plain);
    return status;
}

static tvi_status make_driven(tvi_system **base)
{
    *base = system_of(&forms[0]);
    return TVI_OK;
}

static void unset(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)v, (void)t, (void)force, (void)ctx;
}

static void outside(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)v, (void)t, (void)ctx;
    force[0] = jet_log(-1);
}

static const struct {
    const char *name;
    tvi_status (*make)(tvi_system **base);
    tvi_drive_fn *drive;
    tvi_status status;
    const char *culprit;
} cases[] = {
    {"of a force", make_force, unset, TVI_EUNSUPPORTED, "state the potential"},
    {"of a rescaled system", make_rescaled, unset, TVI_EUNSUPPORTED, "rescaled"},
    {"twice", make_driven, unset, TVI_EUNSUPPORTED, "driven already"},
    {"no function", NULL, NULL, TVI_EINVAL, "drive is NULL"},
    {"nothing set", NULL, unset, TVI_EINVAL, "driving force was not set"},
    {"no value", NULL, outside, TVI_EDOMAIN, "driving force is made of jet_log"},
};

START_TEST(systems_that_are_refused)
{
    tvi_system *base, *driven = (tvi_system *)&base;
    ck_assert_int_eq(cases[_i].make ? cases[_i].make(&base) : forms[0].make(&base), TVI_OK);
    expect_refusal(cases[_i].name, tvi_system_driven(&driven, base, cases[_i].drive, NULL), cases[_i].status,
                   cases[_i].culprit);
    ck_assert_ptr_null(driven);
    tvi_system_free(base);
}
END_TEST

START_TEST(null_is_refused)
{
    tvi_system *driven;
    refused("out is NULL", tvi_system_driven(NULL, NULL, unset, NULL), TVI_EINVAL);
    refused("system is NULL", tvi_system_driven(&driven, NULL, unset, NULL), TVI_EINVAL);
    ck_assert_ptr_null(driven);
}
END_TEST

/* All methods but two; and steps that adapt. */
START_TEST(methods_that_are_refused)
{
    static const struct {
        const char *name;
        int order;
    } methods[] = {{"midpoint", 8}, {"start", 4},    {"end", 4}, {"both-ends", 4}, {"right", 4},
                   {"left", 4},     {"poincare", 4}, {"tvi", 4}, {"svhd", 2},      {"stormer-verlet", 2}};
    tvi_system *system = system_of(&forms[_i]), *rescaled;
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        tvi_options options;
        ck_assert_int_eq(tvi_options_named(methods[i].name, methods[i].order, &options), TVI_OK);
        refused("galerkin or taylor", tvi_options_check(system, &options, NULL), TVI_EUNSUPPORTED);
    }
    refused("take fixed steps, or a tolerance", tvi_system_rescaled(&rescaled, system, scale, NULL), TVI_EUNSUPPORTED);
    ck_assert_ptr_null(rescaled);
    tvi_system_free(system);
}
END_TEST

Suite *suite_refused(void)
{
    Suite *suite = suite_create("refused");
    TCase *tests = tcase_create("refused");
    tcase_add_loop_test(tests, systems_that_are_refused, 0, (int)(sizeof cases / sizeof *cases));
    tcase_add_test(tests, null_is_refused);
    tcase_add_loop_test(tests, methods_that_are_refused, 0, FORMS);
    suite_add_tcase(suite, tests);
    return suite;
}
