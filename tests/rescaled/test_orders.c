/* test_orders.c - Tests the order of every method that serves, two-sided, in (q, p) and t alike. */
#include "hard.h"
#include "rescaled.h"

#include <math.h>

typedef struct {
    double s, h; /* the way in s, and the larger step */
    double tolerance;
} ladder;

/* After the same way in s, so that the error of t counts, too. */
static state state_after(tvi_system *system, const tvi_options *options, const state *start, double s, long steps)
{
    tvi_integrator *integrator;
    state x = *start;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, options), TVI_OK);
    ck_assert_int_eq(tvi_integrate(integrator, s / (double)steps, steps, &x.t, x.q, x.p, NULL, NULL), TVI_OK);
    tvi_integrator_free(integrator);
    return x;
}

static void check_order(tvi_system *system, const state *start, const served *method, double s)
{
    const tvi_options options = options_of(method), exact = tvi_options_default();
    const state at_end = state_after(system, &exact, start, s, 400);
    const long steps = method->order <= 3 ? 800 : method->order <= 4 ? 400 : 200;
    const state coarse = state_after(system, &options, start, s, steps);
    const state fine = state_after(system, &options, start, s, 2 * steps);
    const double slope = log2(state_distance(2, &coarse, &at_end) / state_distance(2, &fine, &at_end));
    ck_assert_msg(fabs(slope - method->order) < 0.3, "%s %d: %.2f", method->name, method->order, slope);
}

START_TEST(orders_on_kepler)
{
    tvi_system *system = rescaled_system(2, NULL, kepler, kepler_scale);
    const state start = kepler_start(0.6);
    check_order(system, &start, &all_served[_i], 12);
    tvi_system_free(system);
}
END_TEST

/* With explicit time, as the next. */
START_TEST(orders_on_sitnikovs_problem)
{
    tvi_system *system = rescaled_system(1, NULL, hard_sitnikov.scene.potential, hard_sitnikov.scale);
    const state start = {0.4, {0.5}, {0.3}};
    check_order(system, &start, &all_served[_i], 12);
    tvi_system_free(system);
}
END_TEST

START_TEST(orders_on_the_driven_problem)
{
    tvi_system *system = rescaled_system(2, driven_mass, driven, driven_scale);
    const state start = driven_start();
    check_order(system, &start, &all_served[_i], 12);
    tvi_system_free(system);
}
END_TEST

Suite *suite_orders(void)
{
    Suite *suite = suite_create("orders");
    TCase *tests = tcase_create("orders");
    tcase_add_loop_test(tests, orders_on_kepler, 0, SERVED);
    tcase_add_loop_test(tests, orders_on_sitnikovs_problem, 0, SERVED);
    tcase_add_loop_test(tests, orders_on_the_driven_problem, 0, SERVED);
    suite_add_tcase(suite, tests);
    return suite;
}
