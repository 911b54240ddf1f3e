/* test_convergence.c - Tests that the passes end at roundoff, wherever they end (docs/method.md section 5): what they
 * leave out does not grow to more than roundoff, for else the method would not be the symplectic one. */
#include "generating.h"
#include "models.h"

#include <math.h>

enum { STEPS = 32, MANY_PASSES = 14, DEGREES = 4 };

static test_state run_with(const model *m, const tvi_options *options)
{
    tvi_system *system = model_system(m);
    tvi_integrator *integrator = integrator_of(system, options);
    test_state x = model_start(m);
    go(integrator, m->h / 4, STEPS, &x);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return x;
}

START_TEST(passes_end_at_roundoff)
{
    const kind *k = &kinds[_i % all_kinds];
    const model *m = models[_i / all_kinds];
    if (!kind_serves(k, m)) return;
    for (int degree = kind_least_degree(k); degree <= DEGREES; degree++) {
        tvi_options options = kind_options(k, degree);
        const test_state usual = run_with(m, &options);
        options.passes = MANY_PASSES;
        const test_state sure = run_with(m, &options);
        const double difference = distance(m->n, &usual, &sure);
        ck_assert_msg(difference < 2e-14, "%s, %s: %.1e", m->name, describe(&options), difference);
    }
}
END_TEST

/* If the first correction shows that the next one is far below roundoff there is no other pass: at the midpoint in
 * most steps but those that check it. If the first contraction tells little there always is. */
START_TEST(one_pass_is_enough)
{
    enum { MANY_STEPS = 400, DEGREE = 7 };
    static const kind of[] = {{TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, false},
                              {TVI_TYPE1, TVI_AT_END, TVI_NODES_ON_CURVE, false}};
    static const double least[] = {17.0 / 16, 2}, most[] = {2.2, 5};
    test_state x[2];
    tvi_system *system = model_system(&model_kepler);
    for (int sure = 0; sure < 2; sure++) {
        tvi_options options = kind_options(&of[_i], DEGREE);
        options.passes = sure * MANY_PASSES;
        tvi_integrator *integrator = integrator_of(system, &options);
        x[sure] = model_start(&model_kepler);
        go(integrator, 0.03125, MANY_STEPS, &x[sure]);
        const double passes = (double)tvi_integrator_stats(integrator)->passes / MANY_STEPS;
        if (!sure) ck_assert_msg(passes > least[_i] && passes < most[_i], "%.2f passes", passes);
        tvi_integrator_free(integrator);
    }
    ck_assert_double_le(distance(2, &x[0], &x[1]), 1e-13);
    tvi_system_free(system);
}
END_TEST

/* Section 5, Kepler, h = 1/16, N = 4: type II at the start 1.1e-6, 6.8e-12, that is 6.2e-6 a pass; type III 1.4e-8 a
 * pass. */
START_TEST(passes_contract_as_measured)
{
    static const kind of[] = {{TVI_TYPE2, TVI_AT_START, TVI_NODES_ON_CURVE, false},
                              {TVI_TYPE3, TVI_AT_START, TVI_NODES_ON_CURVE, false}};
    static const double most[] = {2 * 6.2e-6, 2 * 1.4e-8}, least[] = {6.2e-6 / 2, 0};
    double residual[2];
    for (int pass = 0; pass < 2; pass++) {
        tvi_options options = kind_options(&of[_i], 4);
        options.passes = pass + 1;
        tvi_system *system = model_system(&model_kepler);
        tvi_integrator *integrator = integrator_of(system, &options);
        test_state x = model_start(&model_kepler);
        go(integrator, 0.0625, 1, &x);
        residual[pass] = tvi_integrator_stats(integrator)->residual;
        tvi_integrator_free(integrator);
        tvi_system_free(system);
    }
    const double contraction = residual[1] / residual[0];
    ck_assert_msg(contraction < most[_i] && contraction > least[_i], "%.1e, then %.1e", residual[0], residual[1]);
}
END_TEST

/* Each pass differentiates at most once; the corrector factors once in a step where the passes move z little, and
 * again where they move it far. */
START_TEST(corrector_factors_anew_where_passes_go_far)
{
    static const kind midpoint = {TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, false};
    static const double h[] = {0.015625, 0.5};
    tvi_options options = kind_options(&midpoint, 2);
    tvi_system *system = model_system(&model_kepler);
    tvi_integrator *integrator = integrator_of(system, &options);
    test_state x = model_start(&model_kepler);
    go(integrator, h[_i], 1, &x);
    const long factors = tvi_integrator_stats(integrator)->factorisations;
    const long passes = tvi_integrator_stats(integrator)->passes;
    ck_assert_msg((factors > passes + 1) == (_i > 0), "%ld passes, %ld factorisations", passes, factors);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

Suite *suite_convergence(void)
{
    Suite *suite = suite_create("convergence");
    TCase *tcase = tcase_create("convergence");
    tcase_add_loop_test(tcase, passes_end_at_roundoff, 0, MODELS * all_kinds);
    tcase_add_loop_test(tcase, passes_contract_as_measured, 0, 2);
    tcase_add_loop_test(tcase, one_pass_is_enough, 0, 2);
    tcase_add_loop_test(tcase, corrector_factors_anew_where_passes_go_far, 0, 2);
    suite_add_tcase(suite, tcase);
    return suite;
}
