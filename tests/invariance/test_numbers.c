/* test_numbers.c - Tests systems with 1 to 40 coordinates, and the highest degrees. */
#include "invariance.h"
#include "methods.h"
#include "motions.h"

#include <float.h>
#include <math.h>

/* ---- Numbers of coordinates -------------------------------------------------------------------------------------- */

/* Around 8, from where on a separable system has no matrices. */
static const int numbers[] = {1, 2, 3, 7, 8, 9, 16, 40};
enum { NUMBERS = sizeof numbers / sizeof *numbers, STEPS = 4 };

static const frame exchanged_and_moved = {"exchanged and moved by 1", 1, 1, 1, 1, true};

static const struct {
    const char *motion;
    int n_most; /* the cost of a step grows as n^3 without a separable form */
} chains[] = {{"poles", 40}, {"driven", 40}, {"uneven H", 9}, {"uneven L", 9}};
enum { CHAINS = sizeof chains / sizeof *chains };

START_TEST(any_number_of_coordinates)
{
    const motion *m = motion_named(chains[_i % CHAINS].motion);
    const int n = numbers[_i / CHAINS];
    static const int degrees[] = {LEAST, 2, 8}, composed[] = {LEAST};
    if (n > chains[_i % CHAINS].n_most) return;
    setting own = {m, &as_it_is, n, m->most}, there = {m, &exchanged_and_moved, n, m->most};
    complaints c = complaints_of("%s, n = %d", m->name, n);
    method_list list = {0};
    tvi_system *system = system_of(&own), *moved = system_of(&there);
    const outcome start = start_of(&own);
    add_methods(system, 3, degrees, false, &list);
    add_methods(system, 1, composed, true, &list);
    const double growth = growth_of(&own, STEPS);
    for (int i = 0; i < list.count; i++) {
        const outcome x = run_from(&own, system, &list.options[i], 1, STEPS, &start),
                      y = run_from(&there, moved, &list.options[i], 1, STEPS, &start);
        const double error = distance(&own, &x, &y) / (DBL_EPSILON * (1 + m->cancels + size_of(&own, &x)));
        if (x.status != TVI_OK || y.status != TVI_OK)
            complain(&c, "%s: %s; %s\n", describe(&list.options[i]), tvi_status_string(x.status),
                     tvi_status_string(y.status));
        else if (!(error <= growth * STEPS))
            complain(&c, "%s: %.1e units of roundoff\n", describe(&list.options[i]), error);
    }
    tvi_system_free(system);
    tvi_system_free(moved);
    expect_none(&c);
}
END_TEST

/* ---- The highest degrees ----------------------------------------------------------------------------------------- */

/* Half a step of usual size is exact to roundoff from degree 20 on: all methods agree with Taylor's series of degree
 * 30, and those of the lowest order do not. A unit of roundoff is that of the positions and of what cancels in the
 * force. */
START_TEST(high_degrees_agree)
{
    const motion *m = &motions[_i];
    const int degrees[] = {LEAST, 20, m->n == 1 ? HIGHEST : 40}; /* the cost grows as the square */
    const tvi_options taylor = {.method = TVI_TAYLOR, .degree = 30};
    setting own = {m, &as_it_is, m->n, m->most};
    complaints c = complaints_of("%s", m->name);
    method_list list = {0};
    tvi_system *system = system_of(&own);
    const outcome start = start_of(&own), exact = run_from(&own, system, &taylor, 0.5, 1, &start);
    add_methods(system, 3, degrees, false, &list);
    for (int i = 0; i < list.count; i++) {
        const outcome end = run_from(&own, system, &list.options[i], 0.5, 1, &start);
        const double error = distance(&own, &end, &exact) / (DBL_EPSILON * (m->cancels + size_of(&own, &start)));
        const bool is_low = list.options[i].degree <= 1;
        if (end.status != TVI_OK) complain(&c, "%s: %s\n", describe(&list.options[i]), tvi_status_string(end.status));
        else if (is_low != (error > 4)) complain(&c, "%s: %.1e units of roundoff\n", describe(&list.options[i]), error);
    }
    tvi_system_free(system);
    expect_none(&c);
}
END_TEST

Suite *suite_numbers(void)
{
    Suite *suite = suite_create("numbers");
    TCase *tcase = tcase_create("numbers");
    tcase_add_loop_test(tcase, any_number_of_coordinates, 0, NUMBERS * CHAINS);
    tcase_add_loop_test(tcase, high_degrees_agree, 0, MOTIONS);
    suite_add_tcase(suite, tcase);
    return suite;
}
