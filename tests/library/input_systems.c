/* input_systems.c - Tests systems that cannot be made, and what cannot be asked of one. */
#include "input.h"

#include <float.h>
#include <limits.h>
#include <math.h>

/* ---- Systems ----------------------------------------------------------------------------------------------------- */

static tvi_status state_system(tvi_system **out, statement by, int n, const double mass[], const functions *f,
                               void *ctx)
{
    switch (by) {
    case FORCE: return tvi_system_force(out, n, mass, f->force, ctx);
    case POTENTIAL: return tvi_system_potential(out, n, mass, f->potential, ctx);
    case LAGRANGIAN: return tvi_system_lagrangian(out, n, f->lagrangian, ctx);
    default: return tvi_system_hamiltonian(out, n, f->hamiltonian, ctx);
    }
}

static void harmonic_force(const jet q[], jet t, jet force[], void *ctx)
{
    (void)t, (void)ctx;
    for (int i = 0; i < 2; i++) force[i] = jet_neg(q[i]);
}

jet harmonic(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_dot(q, q, 2));
}

static jet harmonic_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return jet_sub(jet_mul(0.5, jet_dot(v, v, 2)), harmonic(q, t, ctx));
}

static jet harmonic_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    return jet_add(jet_mul(0.5, jet_dot(p, p, 2)), harmonic(q, t, ctx));
}

static jet mixed_kinetic(const jet q[], const jet x[])
{
    return jet_add(jet_mul(0.5, jet_dot(x, x, 2)), jet_mul(jet_sub(q[0], 1), jet_mul(x[0], x[1])));
}

static jet mixed_potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_log(q[0]), jet_pow(q[1], 4));
}

jet mixed_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return jet_sub(mixed_kinetic(q, v), mixed_potential(q, t, ctx));
}

jet mixed_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    return jet_add(mixed_kinetic(q, p), mixed_potential(q, t, ctx));
}

static const functions harmonics = {harmonic_force, harmonic, harmonic_lagrangian, harmonic_hamiltonian};
static const functions no_functions;

void expect_system(const char *what, statement by, int n, const double mass[], const functions *f, void *ctx,
                   tvi_status wanted, const char *culprit)
{
    tvi_system *system = NOT_NULL;
    expect_refusal(what, state_system(&system, by, n, mass, f, ctx), wanted, culprit);
    ck_assert_msg((system != NULL) == (wanted == TVI_OK), "%s: out", what);
    tvi_system_free(system);
}

START_TEST(system_arguments)
{
    static const int sizes[] = {0, -1, INT_MIN, TVI_MAX_DIMENSION + 1, INT_MAX - 1, INT_MAX};
    for (statement by = FORCE; by < STATEMENTS; by++) {
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
            expect_system("n", by, sizes[i], NULL, &harmonics, NULL, TVI_EINVAL, "n = ");
        expect_system("no function", by, 2, NULL, &no_functions, NULL, TVI_EINVAL, "function");
        expect_system("sound", by, 2, NULL, &harmonics, NULL, TVI_OK, "");
        refused("out", state_system(NULL, by, 2, NULL, &harmonics, NULL), TVI_EINVAL);
    }
    ck_assert_int_eq(tvi_system_dimension(NULL), 0);
    tvi_system_free(NULL);
}
END_TEST

static const struct {
    const char *name;
    double mass;
    tvi_status status;
} bad_masses[] = {
    {"0", 0, TVI_EINVAL},
    {"-0", -0.0, TVI_EINVAL},
    {"negative", -1, TVI_EINVAL},
    {"smallest negative", -DBL_TRUE_MIN, TVI_EINVAL},
    {"NaN", NAN, TVI_ENONFINITE},
    {"infinite", INFINITY, TVI_ENONFINITE},
    {"minus infinite", -INFINITY, TVI_ENONFINITE},
};

START_TEST(masses)
{
    for (size_t i = 0; i < sizeof bad_masses / sizeof *bad_masses; i++)
        for (int place = 0; place < 2; place++) {
            double mass[] = {1, 1};
            mass[place] = bad_masses[i].mass;
            for (statement by = FORCE; by <= POTENTIAL; by++)
                expect_system(bad_masses[i].name, by, 2, mass, &harmonics, NULL, bad_masses[i].status,
                              place ? "mass[1]" : "mass[0]");
        }
}
END_TEST

/* The masses are copied: p = M v after the array has gone. */
START_TEST(masses_are_copied)
{
    double mass[] = {2, 3}, p[2];
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 2, mass, harmonic, NULL), TVI_OK);
    mass[0] = mass[1] = NAN;
    ck_assert_int_eq(tvi_momentum(system, 0, (double[]){0, 0}, (double[]){5, 7}, p), TVI_OK);
    ck_assert_double_eq(p[0], 10);
    ck_assert_double_eq(p[1], 21);
    ck_assert_int_eq(tvi_system_dimension(system), 2);
    tvi_system_free(system);
}
END_TEST

/* ---- Asking a system --------------------------------------------------------------------------------------------- */

/* The same H at q_0 = 1, in the three forms that have an energy. */
static const functions mixed = {NULL, mixed_potential, mixed_lagrangian, mixed_hamiltonian};

static tvi_system *create_mixed(statement by)
{
    tvi_system *system;
    ck_assert_int_eq(state_system(&system, by, 2, NULL, &mixed, NULL), TVI_OK);
    return system;
}

START_TEST(energy_without_value)
{
    static const struct {
        const char *name;
        double t, q[2], p[2];
        tvi_status status;
        const char *culprit;
    } cases[] = {
        {"sound", 0, {1, 2}, {3, 4}, TVI_OK, ""},
        {"t NaN", NAN, {1, 2}, {3, 4}, TVI_ENONFINITE, "t = "},
        {"t infinite", INFINITY, {1, 2}, {3, 4}, TVI_ENONFINITE, "t = "},
        {"q NaN", 0, {NAN, 2}, {3, 4}, TVI_ENONFINITE, "q[0]"},
        {"q infinite", 0, {1, INFINITY}, {3, 4}, TVI_ENONFINITE, "q[1]"},
        {"p NaN", 0, {1, 2}, {3, NAN}, TVI_ENONFINITE, "p[1]"},
        {"p infinite", 0, {1, 2}, {-INFINITY, 4}, TVI_ENONFINITE, "p[0]"},
        {"log 0", 0, {0, 2}, {3, 4}, TVI_EDOMAIN, "no power series at 0"},
        {"log of negative", 0, {-1, 2}, {3, 4}, TVI_EDOMAIN, "jet_log has no power series at -1: operation "},
        {"V overflows", 0, {1, 1e100}, {3, 4}, TVI_ENONFINITE, "energy"},
        {"T overflows", 0, {1, 2}, {1e200, 4}, TVI_ENONFINITE, "energy"},
    };
    tvi_system *system = create_mixed((statement)_i);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double H = 42;
        expect_refusal(cases[i].name, tvi_energy(system, cases[i].t, cases[i].q, cases[i].p, &H), cases[i].status,
                       cases[i].culprit);
        ck_assert_double_eq_tol(H, cases[i].status == TVI_OK ? 28.5 : 42, 1e-13);
    }
    tvi_system_free(system);
}
END_TEST

START_TEST(energy_of_a_force)
{
    tvi_system *system;
    double H = 42;
    ck_assert_int_eq(tvi_system_force(&system, 2, NULL, harmonic_force, NULL), TVI_OK);
    expect_refusal("energy", tvi_energy(system, 0, (double[]){1, 0}, (double[]){0, 1}, &H), TVI_EUNSUPPORTED, "force");
    ck_assert_double_eq(H, 42);
    tvi_system_free(system);
}
END_TEST

START_TEST(energy_arguments)
{
    tvi_system *system = create_mixed((statement)_i);
    const double x[] = {1, 2};
    double H = 42;
    refused("system", tvi_energy(NULL, 0, x, x, &H), TVI_EINVAL);
    refused("q", tvi_energy(system, 0, NULL, x, &H), TVI_EINVAL);
    refused("p", tvi_energy(system, 0, x, NULL, &H), TVI_EINVAL);
    refused("H", tvi_energy(system, 0, x, x, NULL), TVI_EINVAL);
    ck_assert_double_eq(H, 42);
    tvi_system_free(system);
}
END_TEST

typedef tvi_status legendre(const tvi_system *, double, const double[], const double[], double[]);
static legendre *const transforms[] = {tvi_momentum, tvi_velocity};

static void expect_no_legendre(const char *culprit, legendre *transform, const tvi_system *system, double t,
                               const double q[], const double x[], tvi_status wanted)
{
    double y[] = {42, 43};
    refused(culprit, transform(system, t, q, x, y), wanted);
    ck_assert_msg(y[0] == 42 && y[1] == 43, "%s: the output was changed", culprit);
}

START_TEST(legendre_arguments)
{
    legendre *const transform = transforms[_i % 2];
    const char *const in = _i % 2 ? "p is NULL" : "v is NULL", *const out = _i % 2 ? "v is NULL" : "p is NULL";
    tvi_system *system = create_mixed((statement)(_i / 2));
    const double q[] = {1, 2}, x[] = {1, 2};
    double y[2];
    expect("sound", transform(system, 0, q, x, y), TVI_OK);
    ck_assert_double_eq_tol(y[0], 1, 1e-15);
    ck_assert_double_eq_tol(y[1], 2, 1e-15);
    expect_no_legendre("system", transform, NULL, 0, q, x, TVI_EINVAL);
    expect_no_legendre("q", transform, system, 0, NULL, x, TVI_EINVAL);
    expect_no_legendre(in, transform, system, 0, q, NULL, TVI_EINVAL);
    refused(out, transform(system, 0, q, x, NULL), TVI_EINVAL);
    expect_no_legendre("t = nan", transform, system, NAN, q, x, TVI_ENONFINITE);
    expect_no_legendre("q[1]", transform, system, 0, (double[]){1, INFINITY}, x, TVI_ENONFINITE);
    expect_no_legendre(_i % 2 ? "p[1]" : "v[1]", transform, system, 0, q, (double[]){1, NAN}, TVI_ENONFINITE);
    tvi_system_free(system);
}
END_TEST

START_TEST(legendre_of_masses)
{
    const double mass[] = {_i == 0 ? 1e10 : 1e-10, 1}, q[] = {1, 2};
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 2, mass, harmonic, NULL), TVI_OK);
    expect_no_legendre("not finite", transforms[_i], system, 0, q, (double[]){1e300, 1}, TVI_ENONFINITE);
    tvi_system_free(system);
}
END_TEST

/* At q_0 = 2 L_vv and H_pp are singular, and at q_0 = 0 V has no value; L = 2 sqrt(1 + v^2) has momenta below 2
 * only. */
START_TEST(legendre_without_value)
{
    const statement by = _i ? HAMILTONIAN : LAGRANGIAN;
    legendre *const stated = transforms[_i], *const solved = transforms[1 - _i];
    const char *const name = "jet_div has no power series at 0"; /* of the derivative of the logarithm */
    tvi_system *system = create_mixed(by);
    expect_no_legendre("singular", solved, system, 0, (double[]){2, 1}, (double[]){1, 2}, TVI_ESINGULAR);
    expect_no_legendre(name, stated, system, 0, (double[]){0, 1}, (double[]){1, 2}, TVI_EDOMAIN);
    expect_no_legendre(name, solved, system, 0, (double[]){0, 1}, (double[]){1, 2}, TVI_EDOMAIN);
    expect_no_legendre("not finite", stated, system, 0, (double[]){1e200, 1}, (double[]){1e200, 1}, TVI_ENONFINITE);
    tvi_system_free(system);
}
END_TEST

static jet relativistic(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_mul(2, jet_sqrt(jet_add(1, jet_sqr(v[0])))), jet_sin(q[0]));
}

START_TEST(velocity_that_does_not_exist)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_lagrangian(&system, 1, relativistic, NULL), TVI_OK);
    double v = 42, H = 42;
    const tvi_status status = tvi_velocity(system, 0, (double[]){0}, (double[]){3}, &v);
    ck_assert_msg(status == TVI_ENOCONV || status == TVI_ESINGULAR || status == TVI_ENONFINITE, "%d", (int)status);
    expect("energy", tvi_energy(system, 0, (double[]){0}, (double[]){3}, &H), status);
    ck_assert(v == 42 && H == 42);
    tvi_system_free(system);
}
END_TEST

/* ---- Texts of statuses ------------------------------------------------------------------------------------------- */

START_TEST(status_texts)
{
    static const int unknown[] = {-1, TVI_STATUS_COUNT, TVI_STATUS_COUNT + 1, INT_MAX, INT_MIN};
    const char *const no_status = tvi_status_string(TVI_STATUS_COUNT);
    for (size_t i = 0; i < sizeof unknown / sizeof *unknown; i++)
        ck_assert_str_eq(tvi_status_string((tvi_status)unknown[i]), no_status);
    for (int i = 0; i < TVI_STATUS_COUNT; i++) {
        ck_assert_str_ne(tvi_status_string((tvi_status)i), "");
        ck_assert_str_ne(tvi_status_string((tvi_status)i), no_status);
        for (int j = 0; j < i; j++)
            ck_assert_str_ne(tvi_status_string((tvi_status)i), tvi_status_string((tvi_status)j));
    }
    ck_assert_int_eq(TVI_OK, 0);
    ck_assert_str_eq(tvi_status_string(TVI_ENOMEM), "out of memory");
}
END_TEST

TCase *tcase_systems(void)
{
    TCase *tcase = tcase_create("systems");
    tcase_add_test(tcase, system_arguments);
    tcase_add_test(tcase, masses);
    tcase_add_test(tcase, masses_are_copied);
    tcase_add_loop_test(tcase, energy_without_value, POTENTIAL, STATEMENTS);
    tcase_add_test(tcase, energy_of_a_force);
    tcase_add_loop_test(tcase, energy_arguments, POTENTIAL, STATEMENTS);
    tcase_add_loop_test(tcase, legendre_arguments, 2 * POTENTIAL, 2 * STATEMENTS);
    tcase_add_loop_test(tcase, legendre_of_masses, 0, 2);
    tcase_add_loop_test(tcase, legendre_without_value, 0, 2);
    tcase_add_test(tcase, velocity_that_does_not_exist);
    tcase_add_test(tcase, status_texts);
    return tcase;
}
