/* test_refused.c - Tests what is refused: systems, methods, and time scales that are none. */
#include "problems/refusals.h"
#include "rescaled.h"

#include <math.h>
#include <string.h>

static void force(const jet q[], jet t, jet out[], void *ctx)
{
    (void)t, (void)ctx;
    out[0] = jet_neg(q[0]);
}

/* L_vv depends on q; v^2 / 2 - q^2 / 2 is separable. */
static jet curved(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(jet_add(1, jet_sqr(q[0])), jet_sqr(v[0]));
}

static jet flat(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_sub(jet_mul(2, jet_sqr(v[0])), jet_sqr(q[0])));
}

static jet spring(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_sqr(q[0]));
}

static jet slope(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return q[0];
}

/* g = ctx, a number. */
static jet number(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *value = ctx;
    (void)q, (void)p, (void)t;
    return jet_const(*value);
}

/* Positive for q > 0 only. */
static jet position(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_mul(2, q[0]);
}

static jet reciprocal(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_exp(jet_mul(800, q[0]));
}

static jet unset(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)p, (void)t, (void)ctx;
    jet value = {0};
    memset(&value, 0, sizeof value);
    return jet_div(value, 0);
}

/* A potential that keeps its q[0], and a g that is it: of another recording. */
static jet keeping(const jet q[], jet t, void *ctx)
{
    *(jet *)ctx = q[0];
    return spring(q, t, NULL);
}

static jet foreign(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)p, (void)t;
    return jet_exp(*(jet *)ctx);
}

/* The base is freed. */
static tvi_system *rescale(tvi_system *base, tvi_rescale_fn *g, void *ctx)
{
    tvi_system *rescaled;
    ck_assert_int_eq(tvi_system_rescaled(&rescaled, base, g, ctx), TVI_OK);
    ck_assert_ptr_nonnull(rescaled);
    tvi_system_free(base);
    return rescaled;
}

/* Refused, with a text that has this in it. */
static void refuse(tvi_system *base, tvi_rescale_fn *g, void *ctx, tvi_status expected, const char *culprit)
{
    tvi_system *rescaled = base;
    refused(culprit, tvi_system_rescaled(&rescaled, base, g, ctx), expected);
    ck_assert_ptr_null(rescaled);
    tvi_system_free(base);
}

static tvi_system *of_potential(tvi_potential_fn *potential)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 1, NULL, potential, NULL), TVI_OK);
    return system;
}

START_TEST(systems)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_force(&system, 1, NULL, force, NULL), TVI_OK);
    refuse(system, NULL, NULL, TVI_EUNSUPPORTED, "a force has no Hamiltonian");
    refuse(NULL, NULL, NULL, TVI_EINVAL, "system is NULL");
    refused("out is NULL", tvi_system_rescaled(NULL, NULL, NULL, NULL), TVI_EINVAL);
    ck_assert_int_eq(tvi_system_lagrangian(&system, 1, curved, NULL), TVI_OK);
    refuse(system, NULL, NULL, TVI_EUNSUPPORTED, "state the Hamiltonian instead of the Lagrangian");
    ck_assert_int_eq(tvi_system_lagrangian(&system, 1, flat, NULL), TVI_OK);
    system = rescale(system, NULL, NULL);
    ck_assert_int_eq(tvi_system_dimension(system), 1);
    refuse(system, NULL, NULL, TVI_EUNSUPPORTED, "rescaled already");
    refuse(of_potential(slope), NULL, NULL, TVI_EDOMAIN, "K = g (H + e): the automatic g has no value (give a g");
}
END_TEST

/* The energy, momenta and velocities are those of the system: here of a Lagrangian, M = 2. */
START_TEST(energy_is_that_of_the_system)
{
    tvi_system *system;
    const double q = 3, p = 5;
    double H, v, back;
    ck_assert_int_eq(tvi_system_lagrangian(&system, 1, flat, NULL), TVI_OK);
    tvi_system *rescaled = rescale(system, NULL, NULL);
    ck_assert_int_eq(tvi_energy(rescaled, 0, &q, &p, &H), TVI_OK);
    ck_assert_double_eq_tol(H, 25.0 / 4 + 9.0 / 2, 4e-15);
    ck_assert_int_eq(tvi_velocity(rescaled, 0, &q, &p, &v), TVI_OK);
    ck_assert_double_eq_tol(v, 2.5, 1e-15);
    ck_assert_int_eq(tvi_momentum(rescaled, 0, &q, &v, &back), TVI_OK);
    ck_assert_double_eq_tol(back, 5, 2e-15);
    tvi_system_free(rescaled);
}
END_TEST

START_TEST(numbers_that_are_no_scale)
{
    double values[] = {0, -1, NAN, INFINITY};
    const tvi_status expected[] = {TVI_EDOMAIN, TVI_EDOMAIN, TVI_ENONFINITE, TVI_ENONFINITE};
    const char *const text = expected[_i] == TVI_EDOMAIN ? "a time scale that is not positive" : "not finite";
    refuse(of_potential(spring), number, &values[_i], expected[_i], text);
}
END_TEST

START_TEST(jets_that_are_no_scale)
{
    tvi_system *system;
    jet kept;
    refuse(of_potential(spring), unset, NULL, TVI_EDOMAIN, "jet_div");
    ck_assert_int_eq(tvi_system_potential(&system, 1, NULL, keeping, &kept), TVI_OK);
    refuse(system, foreign, &kept, TVI_EINVAL, "jets of another recording");
}
END_TEST

/* A step where g is negative, zero or too large is refused, and the state is as it was. */
static void check_step(tvi_rescale_fn *g, double q0, tvi_status expected, const char *culprit)
{
    static const char *const names[] = {"galerkin", "poincare", "right", "left", "taylor"};
    for (int i = 0; i < 5; i++) {
        state start = {.q = {q0}, .p = {0.5}};
        run r = open_run(rescale(of_potential(spring), g, NULL), names[i], 6, &start);
        refused(culprit, run_steps(&r, 0.1, 1), expected);
        ck_assert_ptr_nonnull(strstr(tvi_last_error(), "step of 0.1 in s, of K = g (H + e), from t = 0"));
        ck_assert(memcmp(&r.x, &start, sizeof start) == 0);
        ck_assert_int_eq(tvi_dense(r.integrator, 0.5, start.q, start.p), TVI_EINVAL);
        r.x.q[0] = g == position ? 0.5 : -0.01; /* and it goes on where there is a scale */
        ck_assert_int_eq(run_steps(&r, 0.01, 1), TVI_OK);
        close_run(&r);
    }
}

START_TEST(steps_without_a_scale)
{
    check_step(position, -1, TVI_EDOMAIN, "jet_sqrt has no power series at -2");
    check_step(position, 0, TVI_EDOMAIN, "jet_sqrt has no power series at 0");
    check_step(reciprocal, 1, TVI_ENONFINITE, "not finite");
}
END_TEST

/* A fall to the centre, at t = pi / sqrt 8, takes infinitely many steps: the run ends where the time stands still. */
START_TEST(collision)
{
    const state start = {0, {1, 0}, {0, 0}};
    const double way = _i ? -1 : 1;
    const double end = acos(-1) / sqrt(8);
    run r = open_run(rescaled_system(2, NULL, kepler, kepler_scale), NULL, 0, &start);
    refused("the time does not move",
            tvi_integrate_to(r.integrator, way * 0.5, way * 2, &r.x.t, r.x.q, r.x.p, NULL, NULL), TVI_ENOCONV);
    ck_assert_double_eq_tol(r.x.t, way * end, 1e-15);
    ck_assert_double_le(fabs(r.x.q[0]), 1e-18);
    close_run(&r);
}
END_TEST

static jet square(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_add(jet_sqr(q[0]), jet_sqr(q[1]));
}

/* With g = r^2 the time that is left falls as a power of the number of steps only: either run would take until the end
 * of days, as one of steps far too small does. */
START_TEST(time_that_hardly_moves)
{
    const double way = _i & 1 ? -1 : 1, end = 2 * way;
    const bool to_times = _i & 2, is_rescaled = _i & 4;
    state x = {0, {1, 0}, {0, 0}};
    tvi_system *fall = of_potential(spring), *system = is_rescaled ? rescaled_system(2, NULL, kepler, square) : fall;
    run r = open_run(system, NULL, 0, &x);
    const double h = is_rescaled ? way : way * 1e-17;
    refused("the time hardly moves: by",
            to_times ? tvi_integrate_at(r.integrator, h, &end, 1, &r.x.t, r.x.q, r.x.p, NULL, NULL)
                     : tvi_integrate_to(r.integrator, h, end, &r.x.t, r.x.q, r.x.p, NULL, NULL),
            TVI_ENOCONV);
    const double reached = is_rescaled ? acos(-1) / sqrt(8) : 65536 * 1e-17;
    ck_assert_double_eq_tol(r.x.t * way, reached, 1e-11 * reached);
    close_run(&r);
    if (is_rescaled) tvi_system_free(fall);
}
END_TEST

/* Type I has no generating function, and Stormer-Verlet no mass. */
START_TEST(methods)
{
    static const char *const names[] = {"tvi",       "start",         "end",           "midpoint",
                                        "both-ends", "symmetric-tvi", "stormer-verlet"};
    tvi_system *system = rescale(of_potential(spring), NULL, NULL);
    for (int i = 0; i < 7; i++) {
        tvi_options options;
        tvi_integrator *integrator;
        ck_assert_int_eq(tvi_options_named(names[i], 2, &options), TVI_OK);
        const char *const culprit = i < 6 ? "degenerate" : "mass";
        refused(culprit, tvi_options_check(system, &options, NULL), TVI_EUNSUPPORTED);
        refused(culprit, tvi_integrator_create(&integrator, system, &options), TVI_EUNSUPPORTED);
    }
    tvi_system_free(system);
}
END_TEST

Suite *suite_refused(void)
{
    Suite *suite = suite_create("refused");
    TCase *tests = tcase_create("refused");
    tcase_add_test(tests, systems);
    tcase_add_test(tests, energy_is_that_of_the_system);
    tcase_add_loop_test(tests, numbers_that_are_no_scale, 0, 4);
    tcase_add_test(tests, jets_that_are_no_scale);
    tcase_add_test(tests, steps_without_a_scale);
    tcase_add_loop_test(tests, collision, 0, 2);
    tcase_add_loop_test(tests, time_that_hardly_moves, 0, 8);
    tcase_add_test(tests, methods);
    suite_add_tcase(suite, tests);
    return suite;
}
