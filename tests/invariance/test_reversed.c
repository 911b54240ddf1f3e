/* test_reversed.c - Tests runs forth and back: symmetric methods return to where they began, to roundoff, and the
 * others with their adjoints, in every frame and at every amplitude. */
#include "invariance.h"
#include "methods.h"
#include "method/method.h"
#include "motions.h"

#include <float.h>
#include <math.h>

enum { STEPS = 20 };

static const frame frames[] = {
    {"as it is", 0, 1, 1, 1, false},
    {"moved by 1", 1, 1, 1, 1, false},
    {"moved by 1e6", 1e6, 1, 1, 1, false},
    {"units of 3, 0.7, 11", 0, 3, 0.7, 11, false},
};
enum { FRAMES = sizeof frames / sizeof *frames };

static const double amplitudes[] = {1, 0x1p-20};
enum { AMPLITUDES = sizeof amplitudes / sizeof *amplitudes };

/* How far from the start in units of roundoff; with back, the steps back are made. INFINITY: a step was refused. */
static double missed(const setting *s, const tvi_system *system, const tvi_options *forth, const tvi_options *back)
{
    const outcome start = start_of(s), there = run_from(s, system, forth, 1, STEPS, &start),
                  here = run_from(s, system, back, -1, STEPS, &there);
    const double size = fmax(size_of(s, &there), size_of(s, &start)) + s->frame->move + s->motion->cancels;
    if (there.status != TVI_OK || here.status != TVI_OK) return INFINITY;
    return distance(s, &here, &start) / (DBL_EPSILON * size);
}

/* One unit of roundoff a step, and one for the state that is handed over, enlarged by the motion. */
START_TEST(methods_return)
{
    const motion *m = &motions[_i / FRAMES];
    const frame *f = &frames[_i % FRAMES];
    static const int degrees[] = {LEAST, 2, 8}, composed[] = {LEAST, 3};
    for (int a = 0; a < (m->start ? 1 : AMPLITUDES); a++) {
        setting s = {m, f, m->n, m->most * amplitudes[a]};
        complaints c = complaints_of("%s, %s, amplitude %.0e", m->name, f->name, s.amplitude);
        method_list list = {0};
        tvi_system *system = system_of(&s);
        add_methods(system, 3, degrees, false, &list);
        add_methods(system, 2, composed, true, &list);
        const double growth = growth_of(&s, STEPS);
        for (int i = 0; i < list.count; i++) {
            if (list.options[i].method == TVI_TAYLOR) continue;
            const tvi_options back =
                is_symmetric(&list.options[i]) ? list.options[i] : tvi_adjoint_options(&list.options[i]);
            const double error = missed(&s, system, &list.options[i], &back);
            if (!(error <= growth * (2 * STEPS + 1)))
                complain(&c, "%s: %.1e units of roundoff\n", describe(&list.options[i]), error);
        }
        tvi_system_free(system);
        expect_none(&c);
    }
}
END_TEST

/* Methods that are not symmetric do not return by themselves. (Type I of degree 1 is: its curve is the straight line.)
 */
START_TEST(others_do_not)
{
    const motion *m = &motions[_i];
    static const int degrees[] = {2};
    setting s = {m, &as_it_is, m->n, m->most};
    complaints c = complaints_of("%s", m->name);
    method_list list = {0};
    int tried = 0;
    tvi_system *system = system_of(&s);
    add_methods(system, 1, degrees, false, &list);
    for (int i = 0; i < list.count; i++) {
        if (is_symmetric(&list.options[i])) continue;
        const double error = missed(&s, system, &list.options[i], &list.options[i]);
        if (!(error > 1e5)) complain(&c, "%s: %.1e units of roundoff\n", describe(&list.options[i]), error);
        tried++;
    }
    ck_assert_int_ge(tried, 5);
    tvi_system_free(system);
    expect_none(&c);
}
END_TEST

Suite *suite_reversed(void)
{
    Suite *suite = suite_create("reversed");
    TCase *tcase = tcase_create("reversed");
    tcase_add_loop_test(tcase, methods_return, 0, MOTIONS * FRAMES);
    tcase_add_loop_test(tcase, others_do_not, 0, MOTIONS);
    suite_add_tcase(suite, tcase);
    return suite;
}
