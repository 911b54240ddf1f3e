/* test_motion.c - Tests the oscillator against its closed form: errors, orders, tangent maps, events and saved states.
 */
#include "driven.h"
#include "problems/texts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double END = 8;

/* The larger error of y and y' after so many steps. */
static double error_of(const form *as, const char *method, int order, int steps)
{
    tvi_system *system = system_of(as);
    tvi_integrator *it = integrator_of(system, method, order);
    double t = 0, q, p, y, rate;
    to_form(as, 1, 0, &q, &p);
    ck_assert_int_eq(tvi_integrate(it, END / steps, steps, &t, &q, &p, NULL, NULL), TVI_OK);
    from_form(as, q, p, &y, &rate);
    tvi_integrator_free(it);
    tvi_system_free(system);
    const motion m = exact(END);
    return fmax(fabs(y - m.y), fabs(rate - m.rate));
}

static const struct {
    const char *method;
    int order, steps;
    double least, most; /* error of these steps */
} errors[] = {{"galerkin", 16, 64, 0, 1e-13},
              {"galerkin", 20, 64, 0, 1e-13},
              {"taylor", 20, 64, 0, 1e-13},
              {"galerkin", 4, 64, 1e-9, 1e-4}};
enum { ERRORS = sizeof errors / sizeof *errors };

START_TEST(errors_are_those_of_the_method)
{
    const double error =
        error_of(&forms[_i / ERRORS], errors[_i % ERRORS].method, errors[_i % ERRORS].order, errors[_i % ERRORS].steps);
    ck_assert_double_le(error, errors[_i % ERRORS].most);
    ck_assert_double_ge(error, errors[_i % ERRORS].least);
}
END_TEST

/* With steps such that the errors are far above roundoff. */
static const struct {
    const char *method;
    int order, steps;
} orders[] = {{"galerkin", 2, 200}, {"galerkin", 4, 100}, {"galerkin", 6, 50}, {"galerkin", 8, 32},
              {"taylor", 2, 800},   {"taylor", 4, 200},   {"taylor", 7, 80}};
enum { ORDERS = sizeof orders / sizeof *orders };

START_TEST(orders_are_kept)
{
    const form *as = &forms[_i / ORDERS];
    const char *method = orders[_i % ORDERS].method;
    const int order = orders[_i % ORDERS].order, steps = orders[_i % ORDERS].steps;
    const double coarse = error_of(as, method, order, steps), fine = error_of(as, method, order, 2 * steps);
    ck_assert_double_eq_tol(log2(coarse / fine), order, 0.4);
}
END_TEST

/* D of a linear motion is its own closed form; the area shrinks by the friction. */
START_TEST(tangents_are_exact)
{
    tvi_system *system = system_of(&forms[0]);
    tvi_integrator *it = integrator_of(system, _i ? "taylor" : "galerkin", _i ? 20 : 16);
    double t = 0, q = 1, p = 0, D[2][2] = {{1, 0}, {0, 1}};
    for (int step = 0; step < 64; step++)
        ck_assert_int_eq(tvi_step_tangent(it, END / 64, &t, &q, &p, &D[0][0], 2), TVI_OK);
    const motion m = exact(END);
    for (int row = 0; row < 2; row++)
        for (int column = 0; column < 2; column++)
            ck_assert_double_eq_tol(D[row][column], m.by_start[row][column], 1e-13);
    ck_assert_double_eq_tol(D[0][0] * D[1][1] - D[0][1] * D[1][0], exp(-2 * FRICTION * END), 1e-13);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

static jet turning(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)t, (void)ctx;
    return p[0];
}

START_TEST(events_are_on_the_motion)
{
    const form *as = &forms[_i];
    tvi_system *system = system_of(as);
    tvi_integrator *it = integrator_of(system, "galerkin", 16);
    tvi_event *event;
    double t = 0, q, p;
    ck_assert_int_eq(tvi_event_create(&event, 1, TVI_EITHER, true, turning, NULL), TVI_OK);
    to_form(as, 1, 0, &q, &p);
    ck_assert_int_eq(
        tvi_integrate_events(it, 0.125, 80, (const tvi_event *const[]){event}, 1, &t, &q, &p, NULL, NULL, NULL),
        TVI_ESTOPPED);
    ck_assert_double_eq_tol(exact(t).rate, 0, 1e-13);
    ck_assert_double_ge(t, 0.5);
    tvi_event_free(event);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

START_TEST(saved_states_go_on)
{
    tvi_system *system = system_of(&forms[_i]);
    tvi_integrator *one = integrator_of(system, "galerkin", 16), *two = integrator_of(system, "galerkin", 16);
    double t = 0, q, p, at[3];
    to_form(&forms[_i], 1, 0, &q, &p);
    ck_assert_int_eq(tvi_integrate(one, 0.125, 20, &t, &q, &p, NULL, NULL), TVI_OK);
    char *text = text_of_state(one, t, &q, &p);
    ck_assert_int_eq(tvi_state_from_text(two, text, strlen(text), &at[0], &at[1], &at[2]), TVI_OK);
    ck_assert(memcmp(at, (const double[]){t, q, p}, sizeof at) == 0);
    ck_assert_int_eq(tvi_integrate(one, 0.125, 20, &t, &q, &p, NULL, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrate(two, 0.125, 20, &at[0], &at[1], &at[2], NULL, NULL), TVI_OK);
    ck_assert(memcmp(at, (const double[]){t, q, p}, sizeof at) == 0);
    free(text);
    tvi_integrator_free(one);
    tvi_integrator_free(two);
    tvi_system_free(system);
}
END_TEST

Suite *suite_motion(void)
{
    Suite *suite = suite_create("driven");
    TCase *tests = tcase_create("motion");
    tcase_add_loop_test(tests, errors_are_those_of_the_method, 0, FORMS * ERRORS);
    tcase_add_loop_test(tests, orders_are_kept, 0, FORMS * ORDERS);
    tcase_add_loop_test(tests, tangents_are_exact, 0, 2);
    tcase_add_loop_test(tests, events_are_on_the_motion, 0, FORMS);
    tcase_add_loop_test(tests, saved_states_go_on, 0, FORMS);
    suite_add_tcase(suite, tests);
    return suite;
}
