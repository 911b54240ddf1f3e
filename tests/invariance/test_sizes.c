/* test_sizes.c - Tests motions of any size, down to the least numbers: no step is refused, and the tail is finite. */
#include "invariance.h"
#include "methods.h"

#include <float.h>
#include <math.h>

enum { EXPONENT_STEP = 4, EXPONENTS = 320 / EXPONENT_STEP, STEPS = 8 };

static jet spring(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_div(jet_sqr(q[0]), 2);
}

static jet spring_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_div(jet_add(jet_sqr(q[0]), jet_sqr(p[0])), 2);
}

static jet spring_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_div(jet_sub(jet_sqr(v[0]), jet_sqr(q[0])), 2);
}

static tvi_status make_spring(int form, tvi_system **system)
{
    return form == 0   ? tvi_system_potential(system, 1, NULL, spring, NULL)
           : form == 1 ? tvi_system_hamiltonian(system, 1, spring_hamiltonian, NULL)
                       : tvi_system_lagrangian(system, 1, spring_lagrangian, NULL);
}

/* Runs a spring from q = p = amplitude; q is the end over the amplitude. */
static tvi_status run_spring(const tvi_system *system, const tvi_options *options, double amplitude, double *q,
                             double *tail)
{
    tvi_integrator *integrator;
    double t = 0, x = amplitude, p = amplitude;
    tvi_status status = tvi_integrator_create(&integrator, system, options);
    if (status != TVI_OK) return status;
    status = tvi_integrate(integrator, 0.02, STEPS, &t, &x, &p, NULL, NULL);
    *tail = tvi_integrator_stats(integrator)->largest_tail;
    *q = x / amplitude;
    tvi_integrator_free(integrator);
    return status;
}

/* A linear motion is the same at every size, but for some units of the least number. */
START_TEST(springs_of_any_amplitude)
{
    static const int degrees[] = {LEAST, 8};
    complaints c = complaints_of("spring, form %d", _i);
    method_list list = {0};
    tvi_system *system;
    ck_assert_int_eq(make_spring(_i, &system), TVI_OK);
    add_methods(system, 2, degrees, false, &list);
    for (int i = 0; i < list.count; i++) {
        double right, q = NAN, tail = NAN;
        ck_assert_msg(run_spring(system, &list.options[i], 1, &right, &tail) == TVI_OK, "%s: %s",
                      describe(&list.options[i]), tvi_last_error());
        const double largest = tail;
        for (int k = 0; k < EXPONENTS; k++) {
            const double amplitude = pow(10, -k * EXPONENT_STEP), least = 0x1p-1074 / amplitude;
            const tvi_status status = run_spring(system, &list.options[i], amplitude, &q, &tail);
            if (status != TVI_OK) complain(&c, "%s, %g: %s\n", describe(&list.options[i]), amplitude, tvi_last_error());
            else if (!(tail <= 1.5 * largest + 1e-9))
                complain(&c, "%s, %g: tail %g for %g\n", describe(&list.options[i]), amplitude, tail, largest);
            else if (!(fabs(q - right) <= 1e-13 + 100 * STEPS * least))
                complain(&c, "%s, %g: %g for %g\n", describe(&list.options[i]), amplitude, q, right);
        }
    }
    tvi_system_free(system);
    expect_none(&c);
}
END_TEST

static void brake(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)t, (void)ctx;
    force[0] = jet_neg(v[0]);
}

/* A spring of each form, or the damped one (form 3). */
static tvi_status make_damped_spring(int form, tvi_system **system)
{
    if (form < 3) return make_spring(form, system);
    tvi_system *base;
    tvi_status status = make_spring(0, &base);
    if (status == TVI_OK) status = tvi_system_driven(system, base, brake, NULL);
    tvi_system_free(base);
    return status;
}

enum { MANY = 20000 };
static int is_endless(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)t, (void)q, (void)p, (void)ctx;
    return step >= MANY;
}

/* Runs a spring from q = p = amplitude to t_end and returns its number of steps, or MANY if the run fails. */
static long steps_to_tolerance(const tvi_system *system, double tolerance, double amplitude, double t_end, double *q)
{
    tvi_options options;
    tvi_integrator *integrator;
    double t = 0, p = amplitude;
    *q = amplitude;
    ck_assert_int_eq(tvi_options_named("taylor", tvi_taylor_order(tolerance), &options), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    const tvi_status status = tvi_integrate_tolerance(integrator, tolerance, t_end, &t, q, &p, is_endless, NULL);
    const long steps = tvi_integrator_stats(integrator)->steps;
    tvi_integrator_free(integrator);
    return status == TVI_OK ? steps : MANY;
}

/* Runs to a tolerance of motions of any size take the same steps; below DBL_MIN / DBL_EPSILON they may take fewer, with
 * the error of that size, and none more. */
START_TEST(tolerance_of_any_amplitude)
{
    static const double tolerances[] = {1e-5, 1e-9, 1e-12, 1e-14};
    complaints c = complaints_of("spring to a tolerance, form %d", _i);
    tvi_system *system;
    ck_assert_int_eq(make_damped_spring(_i, &system), TVI_OK);
    for (int i = 0; i < 4; i++) {
        double right, q;
        const long usual = steps_to_tolerance(system, tolerances[i], 1, 10, &right);
        ck_assert_int_lt(usual, 100);
        for (int k = 0; k < EXPONENTS; k++) {
            const double amplitude = pow(10, -k * EXPONENT_STEP), size = fmax(amplitude, DBL_MIN / DBL_EPSILON);
            const long steps = steps_to_tolerance(system, tolerances[i], amplitude, 10, &q);
            if (!(steps <= usual + 2))
                complain(&c, "%g, tolerance %g: %ld steps for %ld: %s\n", amplitude, tolerances[i], steps, usual,
                         tvi_last_error());
            else if (!(fabs(q - right * amplitude) <= 100 * tolerances[i] * size))
                complain(&c, "%g, tolerance %g: %g for %g\n", amplitude, tolerances[i], q, right * amplitude);
        }
    }
    tvi_system_free(system);
    expect_none(&c);
}
END_TEST

/* A damped spring comes to rest, and stays there: twice the time takes no more than twice the steps. */
START_TEST(damped_springs_come_to_rest)
{
    static const double tolerances[] = {1e-5, 1e-9, 1e-12, 1e-14};
    tvi_system *system;
    ck_assert_int_eq(make_damped_spring(3, &system), TVI_OK);
    for (int i = 0; i < 4; i++) {
        double q;
        const long falling = steps_to_tolerance(system, tolerances[i], 1, 1000, &q);
        ck_assert_int_lt(falling, MANY);
        for (double t_end = 2000; t_end <= 16000; t_end *= 2) {
            ck_assert_int_le(steps_to_tolerance(system, tolerances[i], 1, t_end, &q), (long)(t_end / 1000) * falling);
            ck_assert_double_le(fabs(q), 100 * tolerances[i] * DBL_MIN / DBL_EPSILON);
        }
    }
    tvi_system_free(system);
}
END_TEST

/* A pulse of the force at t = 50, which grows from 0 through the least numbers. */
static jet pulse(jet t) { return jet_exp(jet_neg(jet_sqr(jet_sub(t, 50)))); }
static jet pushed(const jet q[], jet t, void *ctx) { return jet_sub(spring(q, t, ctx), jet_mul(q[0], pulse(t))); }
static void push(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)v, (void)ctx;
    force[0] = pulse(t);
}

static tvi_status make_pushed(bool is_driven, tvi_system **system)
{
    if (!is_driven) return tvi_system_potential(system, 1, NULL, pushed, NULL);
    tvi_system *base;
    tvi_status status = tvi_system_potential(&base, 1, NULL, spring, NULL);
    if (status == TVI_OK) status = tvi_system_driven(system, base, push, NULL);
    tvi_system_free(base);
    return status;
}

/* q(100) = sqrt(pi) exp(-1/4) sin(50) from rest, wherever the run begins. */
START_TEST(pulse_from_rest)
{
    static const struct {
        const char *method;
        int order;
        double h;
    } ways[] = {{"galerkin", 16, 0.1}, {"galerkin", 16, 0.5}, {"taylor", 12, 0.1}, {"midpoint", 12, 0.1}};
    const double right = sqrt(acos(-1)) * exp(-0.25) * sin(50);
    tvi_system *system;
    ck_assert_int_eq(make_pushed(_i, &system), TVI_OK);
    for (size_t i = 0; i < sizeof ways / sizeof *ways - (size_t)_i; i++)
        for (int start = 0; start <= 40; start += 5) {
            tvi_options options;
            tvi_integrator *integrator;
            double t = start, q = 0, p = 0;
            ck_assert_int_eq(tvi_options_named(ways[i].method, ways[i].order, &options), TVI_OK);
            ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
            ck_assert_msg(tvi_integrate_to(integrator, ways[i].h, 100, &t, &q, &p, NULL, NULL) == TVI_OK,
                          "%s, h = %g, from %d: %s", ways[i].method, ways[i].h, start, tvi_last_error());
            ck_assert_double_le(fabs(q - right), 1e-10);
            ck_assert(isfinite(tvi_integrator_stats(integrator)->largest_tail));
            tvi_integrator_free(integrator);
        }
    tvi_system_free(system);
}
END_TEST

Suite *suite_sizes(void)
{
    Suite *suite = suite_create("sizes");
    TCase *tcase = tcase_create("sizes");
    tcase_add_loop_test(tcase, springs_of_any_amplitude, 0, 3);
    tcase_add_loop_test(tcase, tolerance_of_any_amplitude, 0, 4);
    tcase_add_test(tcase, damped_springs_come_to_rest);
    tcase_add_loop_test(tcase, pulse_from_rest, 0, 2);
    suite_add_tcase(suite, tcase);
    return suite;
}
