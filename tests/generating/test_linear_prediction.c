/* test_linear_prediction.c - steps of the Galerkin curve that are predicted by what was fitted to those before
 * (docs/method.md section 5). */
#include "galerkin/step.h"
#include "generating.h"
#include "models.h"
#include "run/integrator.h"

#include <math.h>
#include <string.h>

typedef struct {
    tvi_system *system;
    tvi_integrator *it;
    galerkin *work;
    test_state x;
} predicted_run;

static predicted_run begin(const model *m, int nodes, double tolerance, bool is_fitted)
{
    predicted_run r = {.system = model_system(m), .x = model_start(m)};
    tvi_options options = kind_options(&kinds[kind_count], nodes);
    options.tolerance = tolerance;
    r.it = integrator_of(r.system, &options);
    r.work = r.it->work;
    if (!is_fitted) r.work->prediction.last = NULL;
    return r;
}

static void end(predicted_run *r)
{
    tvi_integrator_free(r->it);
    tvi_system_free(r->system);
}

static double passes_of(const predicted_run *r)
{
    const tvi_stats *stats = tvi_integrator_stats(r->it);
    return (double)stats->passes / (double)stats->steps;
}

/* Regular motions take fewer passes for the same motion: the bounds have two thirds of the part that is saved. Others
 * take not many more. */
START_TEST(regular_motions_save_passes)
{
    static const struct {
        const model *of;
        int nodes;
        double h, saved; /* the least part of the passes; negative where some may be lost */
    } rows[] = {{&model_pendulum, 8, 0.5, 0.12},
                {&model_henon_heiles, 8, 0.75, 0.05},
                {&model_henon_heiles, 6, 0.4, 0.055},
                {&model_nonseparable, 8, 0.25, 0.17},
                {&model_sheared_hamiltonian, 8, 0.25, -0.5},
                {&model_sheared_lagrangian, 8, 0.25, -0.5},
                {&model_double_pendulum, 8, 0.05, -0.5},
                {&model_kepler, 8, 0.5, -0.5},
                {&model_kepler, 10, 0.8, -0.5},
                {&model_henon_heiles, 8, 0.1875, -0.5}};
    enum { STEPS = 1500 };
    const model *m = rows[_i].of;
    predicted_run with = begin(m, rows[_i].nodes, 0, true), without = begin(m, rows[_i].nodes, 0, false);
    go(with.it, rows[_i].h, STEPS, &with.x);
    go(without.it, rows[_i].h, STEPS, &without.x);
    const double saved = 1 - passes_of(&with) / passes_of(&without), apart = distance(m->n, &with.x, &without.x);
    ck_assert_msg(saved >= rows[_i].saved, "%s: %.3f of the passes are saved", m->name, saved);
    ck_assert_msg(apart < 2e-12, "%s: %.1e apart", m->name, apart);
    end(&with);
    end(&without);
}
END_TEST

/* Two pendulums that do not know of each other, of masses 1 and `mass`. */
static jet pendulums(const jet q[], jet t, void *ctx)
{
    const double mass = *(const double *)ctx;
    (void)t;
    return jet_neg(jet_add(jet_cos(q[0]), jet_mul(mass, jet_cos(q[1]))));
}

/* Momenta of different size count alike. */
START_TEST(all_unknowns_count)
{
    const tvi_options options = kind_options(&kinds[kind_count], 8);
    double mass[] = {1, _i > 0 ? 1e8 : 1}, passes[2];
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 2, mass, pendulums, &mass[1]), TVI_OK);
    for (int is_fitted = 0; is_fitted < 2; is_fitted++) {
        tvi_integrator *it = integrator_of(system, &options);
        test_state x = {.q = {0.9, 1.7}};
        if (!is_fitted) ((galerkin *)it->work)->prediction.last = NULL;
        go(it, 0.5, 3000, &x);
        passes[is_fitted] = (double)tvi_integrator_stats(it)->passes;
        tvi_integrator_free(it);
    }
    const double saved = 1 - passes[1] / passes[0];
    ck_assert_msg(saved > 0.05, "mass %g: %.3f of the passes are saved", mass[1], saved);
    tvi_system_free(system);
}
END_TEST

/* An oscillator, whose drives are those of two steps before by two coefficients: of curves of any degree, and of steps
 * of which polynomials say nothing. */
START_TEST(oscillators_are_predicted_exactly)
{
    const double h = 1.5;
    predicted_run r = begin(&model_pendulum, _i, 0, true);
    galerkin_fitting *last = r.work->prediction.last;
    r.x.q[0] = 1e-9;
    r.x.p[0] = 0;
    for (int more = 0; more < 3; more++) go(r.it, h, (int)r.work->prediction.first_wait, &r.x);
    ck_assert_msg(last->fitted == h, "%d nodes", _i);
    const double fitted = r.work->predictor.last->pace.first;
    r.work->prediction.last = NULL;
    tvi_galerkin_predict_by(&r.work->predictor, NULL);
    go(r.it, h, 2, &r.x);
    const double by_polynomials = r.work->predictor.last->pace.first;
    ck_assert_msg(sqrt(fitted) < 1e-6 && sqrt(by_polynomials) > 1e-3, "%d nodes: first movements of %.1e and %.1e", _i,
                  sqrt(fitted), sqrt(by_polynomials));
    end(&r);
}
END_TEST

/* What was fitted serves again where steps of another size came between, and does not serve those. */
START_TEST(fits_belong_to_their_step_size)
{
    const double h = 0.75;
    predicted_run r = begin(&model_henon_heiles, 8, 0, true);
    const galerkin_linear_prediction *w = &r.work->prediction;
    const double *const *table = &r.work->predictor.extrapolation[GALERKIN_FROM_TWO];
    go(r.it, h, (int)w->first_wait + 1, &r.x);
    const double *fitted = w->tables[w->last->turn];
    ck_assert_ptr_eq(*table, fitted);
    go(r.it, h / 2, 3, &r.x);
    ck_assert_ptr_eq(*table, r.work->predictor.polynomial[GALERKIN_FROM_TWO]);
    go(r.it, h, 3, &r.x);
    ck_assert_ptr_eq(*table, fitted);
    ck_assert(w->last->steps == 3);
    r.x.t += 100; /* no step behind another one */
    go(r.it, h, 1, &r.x);
    ck_assert(w->last->steps == 1);
    end(&r);
}
END_TEST

/* Coefficients with which steps take as many passes as without serve no longer; later there are others. */
START_TEST(fits_that_save_nothing_are_given_up)
{
    const double h = 0.75;
    predicted_run r = begin(&model_henon_heiles, 8, 0, true);
    galerkin_fitting *last = r.work->prediction.last;
    const int first = (int)r.work->prediction.first_wait;
    go(r.it, h, first + 1, &r.x);
    ck_assert(last->fitted == h && last->plain > 4 && last->plain < 11);
    go(r.it, h, 3 * first, &r.x);
    ck_assert(last->fitted == h && last->from == 4 * first);
    last->plain = 0;
    go(r.it, h, 12 * first, &r.x);
    ck_assert(last->fitted == 0 && last->from == 16 * first);
    go(r.it, h, 48 * first, &r.x);
    ck_assert(last->fitted == h && last->plain > 4 && last->plain < 11);
    end(&r);
}
END_TEST

/* A run that goes on from a saved state does so to the bit, before, between and after the windows of steps that are
 * kept, and after a step that failed. */
START_TEST(states_have_the_fits)
{
    enum { MORE = 400 };
    const double h = 0.75;
    predicted_run r = begin(&model_henon_heiles, 8, 0, true), other = begin(&model_henon_heiles, 8, 0, true);
    static char buffer[1 << 17];
    size_t size = sizeof buffer;
    go(other.it, h, 250, &other.x); /* has fits of its own */
    go(r.it, h, 95 + 16 * _i, &r.x);
    ck_assert_int_eq(tvi_state_save(r.it, buffer, &size), TVI_OK);
    const test_state start = r.x;
    go(r.it, h, MORE, &r.x);
    ck_assert(r.work->prediction.last->fitted == h);
    for (int fails = 0; fails < 2; fails++) {
        test_state y = start;
        ck_assert_int_eq(tvi_state_load(other.it, buffer, size), TVI_OK);
        if (fails) ck_assert_int_ne(tvi_step(other.it, 1e4, &y.t, y.q, y.p), TVI_OK);
        go(other.it, h, MORE, &y);
        ck_assert_mem_eq(&y, &r.x, sizeof y);
    }
    end(&r);
    end(&other);
}
END_TEST

/* Errors of H of order 20, whose own error is less than roundoff. */
static sample errors_to(double tolerance)
{
    enum { STEPS = 4000 };
    const model *m = &model_henon_heiles;
    sample errors = {0};
    for (int k = 0; k < ORBITS; k++) {
        predicted_run r = begin(m, 10, tolerance, true);
        for (int i = 0; i < m->n; i++) r.x.q[i] += start_shift(k), r.x.p[i] += start_shift(k);
        const double start = state_energy(r.system, &r.x);
        go(r.it, 0.61803, STEPS, &r.x);
        ck_assert(r.work->prediction.last->fitted > 0);
        sample_add(&errors, state_energy(r.system, &r.x) - start);
        end(&r);
    }
    return errors;
}

/* The control ends its passes sooner, so that a part of what the prediction lacks is left. Its ratio is at least
 * 10.8. */
START_TEST(energy_does_not_drift)
{
    const sample errors = errors_to(0), biased = errors_to(1e-12);
    ck_assert_double_lt(sample_drift(&errors), NO_DRIFT);
    ck_assert_double_gt(sample_drift(&biased), NO_DRIFT);
}
END_TEST

Suite *suite_linear_prediction(void)
{
    Suite *suite = suite_create("linear prediction");
    TCase *tcase = tcase_create("linear prediction");
    tcase_add_loop_test(tcase, regular_motions_save_passes, 0, 10);
    tcase_add_loop_test(tcase, all_unknowns_count, 0, 2);
    tcase_add_loop_test(tcase, oscillators_are_predicted_exactly, 1, 11);
    tcase_add_test(tcase, fits_belong_to_their_step_size);
    tcase_add_test(tcase, fits_that_save_nothing_are_given_up);
    tcase_add_loop_test(tcase, states_have_the_fits, 0, 8);
    tcase_add_test(tcase, energy_does_not_drift);
    suite_add_tcase(suite, tcase);
    return suite;
}
