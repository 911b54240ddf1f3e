/* test_galerkin.c - Tests runs of the library's Galerkin curve against the baseline's Gauss collocation, which shares
 * nothing with it. */
#include "baselines.h"

#include <string.h>

static const struct {
    const scene *scene;
    int order;
    double h;
    long steps;
    double most; /* what roundoff does to q in this run */
} runs[] = {
    {&scene_kepler, 4, 0.125, 800, 2e-11},  {&scene_kepler, 10, 0.25, 400, 2e-11},
    {&scene_kepler, 16, 0.25, 1000, 5e-12}, {&scene_solar, 16, 400, 500, 3e-11},
    {&scene_solar, 8, 100, 200, 3e-11},     {&scene_pendulum, 14, 0.25, 80, 1e-12},
    {&scene_fpu, 12, 0.03125, 320, 1e-11},  {&scene_fpu, 16, 0.078125, 128, 1e-11},
};
enum { RUNS = sizeof runs / sizeof *runs };

START_TEST(runs_are_those_of_gauss_collocation)
{
    const scene *s = runs[_i].scene;
    const baseline *gauss = baseline_find("gauss", runs[_i].order);
    const baseline_task task = {.scene = s, .h = runs[_i].h, .steps = runs[_i].steps};
    const tvi_options options = {.method = TVI_TYPE1, .expansion = TVI_AT_NODES, .order = runs[_i].order};
    baseline_counts counts;
    test_state x = {0}, y = {0};
    memcpy(x.q, s->q, (size_t)s->n * sizeof *x.q);
    memcpy(x.p, s->p, (size_t)s->n * sizeof *x.p);
    y = x;
    ck_assert_int_eq(gauss->run(gauss, &task, y.q, y.p, &counts), TVI_OK);
    tvi_system *system;
    ck_assert_int_eq(scene_system(s, &system), TVI_OK);
    tvi_integrator *it;
    ck_assert_int_eq(tvi_integrator_create(&it, system, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrate(it, task.h, task.steps, &x.t, x.q, x.p, NULL, NULL), TVI_OK);
    const double difference = state_difference(s->n, &x, &y).q, passes = (double)tvi_integrator_stats(it)->passes;
    ck_assert_msg(difference < runs[_i].most, "%s, order %d: %.1e", s->name, runs[_i].order, difference);
    const double part = passes / (double)counts.passes;
    ck_assert_msg(part < 1.5 && part > 0.55, "%s, order %d: %g of the passes", s->name, runs[_i].order, part);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

Suite *suite_galerkin(void)
{
    Suite *suite = suite_create("galerkin");
    TCase *tcase = tcase_create("runs");
    tcase_add_loop_test(tcase, runs_are_those_of_gauss_collocation, 0, RUNS);
    suite_add_tcase(suite, tcase);
    return suite;
}
