/* test_refused.c - Tests parameters that are none, and values that are no numbers. */
#include "parameters.h"
#include "problems/refusals.h"

#include <math.h>
#include <string.h>

typedef struct {
    const char *name;
    int index[2];
    double value[2];
    bool of_a_number;
    tvi_status status;
    const char *culprit;
} stated;

static const stated cases[] = {
    {"one twice", {0, 0}, {1, 1}, false, TVI_OK, ""},
    {"the largest index", {999, 0}, {1, 2}, false, TVI_OK, ""},
    {"two values", {0, 0}, {1, 2}, false, TVI_EINVAL, "made of a parameter that was recorded with another value"},
    {"index below 0", {-1, 0}, {1, 1}, false, TVI_EINVAL, "index is out of range"},
    {"index too large", {0, 1000}, {1, 1}, false, TVI_EINVAL, "index is out of range"},
    {"of a number", {0, 1}, {1, 1}, true, TVI_EINVAL, "names no recording"},
    {"not a number", {0, 1}, {1, NAN}, false, TVI_ENONFINITE, "not finite"},
    {"infinite", {0, 1}, {INFINITY, 1}, false, TVI_ENONFINITE, "not finite"},
};

static jet spring(const jet q[], jet t, void *ctx)
{
    const stated *c = ctx;
    (void)t;
    const jet of = c->of_a_number ? jet_const(1) : q[0];
    return jet_mul(jet_mul(jet_parameter(of, c->index[0], c->value[0]), jet_parameter(of, c->index[1], c->value[1])),
                   jet_sqr(q[0]));
}

START_TEST(recordings_that_are_refused)
{
    const stated *c = &cases[_i];
    tvi_system *system;
    expect_refusal(c->name, tvi_system_potential(&system, 1, NULL, spring, (void *)c), c->status, c->culprit);
    if (c->status == TVI_OK) ck_assert_int_eq(tvi_system_parameters(system), 1 + (c->index[0] > 0 ? c->index[0] : 0));
    tvi_system_free(system);
}
END_TEST

/* The old values stay, bit for bit. */
START_TEST(values_that_are_refused)
{
    tvi_system *system = system_of(&forms[0], NULL);
    tvi_integrator *it = integrator_of(system, &methods[0]);
    ck_assert_int_eq(tvi_integrator_set_parameters(it, other), TVI_OK);
    const state before = run(it, 10);
    refused("value is NULL", tvi_integrator_set_parameters(it, NULL), TVI_EINVAL);
    refused("integrator is NULL", tvi_integrator_set_parameters(NULL, other), TVI_EINVAL);
    refused("value[1] is not finite", tvi_integrator_set_parameters(it, (const double[]){1, NAN}), TVI_ENONFINITE);
    refused("value[0] is not finite", tvi_integrator_set_parameters(it, (const double[]){INFINITY, 1}), TVI_ENONFINITE);
    tvi_integrator_reset(it);
    const state after = run(it, 10);
    ck_assert(memcmp(&before, &after, sizeof before) == 0);
    ck_assert_int_eq(tvi_system_parameters(NULL), 0);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* A system without parameters has nothing to set. */
START_TEST(no_parameters)
{
    tvi_system *system = system_of(&forms[0], recorded);
    tvi_integrator *it = integrator_of(system, &methods[0]);
    ck_assert_int_eq(tvi_integrator_set_parameters(it, recorded), TVI_OK);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

Suite *suite_refused(void)
{
    Suite *suite = suite_create("refused");
    TCase *tests = tcase_create("refused");
    tcase_add_loop_test(tests, recordings_that_are_refused, 0, (int)(sizeof cases / sizeof *cases));
    tcase_add_test(tests, values_that_are_refused);
    tcase_add_test(tests, no_parameters);
    suite_add_tcase(suite, tests);
    return suite;
}
