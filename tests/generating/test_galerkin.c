/* test_galerkin.c - Tests the Galerkin curve: Gauss collocation for every form of system, its predictor and its passes
 * (docs/method.md sections 4 to 6). Properties that it shares with the generating functions are tested in the other
 * suites. */
#include "generating.h"
#include "models.h"
#include "algebra/quadrature.h"

#include <float.h>
#include <math.h>
#include <string.h>

static tvi_options galerkin(int nodes) { return kind_options(&kinds[kind_count], nodes); }

/* ---- Any Hamiltonian: the canonical exchange --------------------------------------------------------------------- */

/* Collocation does not see a linear canonical change of the variables: Q = p, P = -q, H = sum Q_i^2/(2 m_i) + V(-P). */
static jet kepler_potential(const jet q[], jet t)
{
    (void)t;
    return jet_neg(jet_pow(jet_add(jet_sqr(q[0]), jet_sqr(q[1])), -0.5));
}

/* Quartic springs, driven. */
static jet driven_potential(const jet q[], jet t)
{
    const jet d = jet_sub(q[1], q[0]);
    const jet springs = jet_add(jet_add(jet_sqr(q[0]), jet_pow(d, 4)), jet_mul(0.5, jet_sqr(q[1])));
    return jet_add(springs, jet_mul(jet_mul(0.75, q[0]), jet_cos(jet_mul(1.7, t))));
}

typedef struct {
    jet (*potential)(const jet q[], jet t);
    double mass[2], q[2], p[2], h;
} exchange_case;

static const exchange_case exchange_cases[] = {
    {kepler_potential, {1, 1}, {1, 0}, {0, 0.8}, 0.125},
    {driven_potential, {1.5, 0.4}, {0.3, -0.2}, {0.5, 1}, 0.125},
};
enum { EXCHANGE_CASES = sizeof exchange_cases / sizeof *exchange_cases };

static jet plain_potential(const jet q[], jet t, void *ctx) { return ((const exchange_case *)ctx)->potential(q, t); }

static jet exchanged_hamiltonian(const jet Q[], const jet P[], jet t, void *ctx)
{
    const exchange_case *c = ctx;
    const jet q[] = {jet_neg(P[0]), jet_neg(P[1])};
    const jet kinetic = jet_add(jet_mul(0.5 / c->mass[0], jet_sqr(Q[0])), jet_mul(0.5 / c->mass[1], jet_sqr(Q[1])));
    return jet_add(kinetic, c->potential(q, t));
}

START_TEST(exchange_of_variables_changes_nothing)
{
    exchange_case c = exchange_cases[_i % EXCHANGE_CASES];
    const tvi_options options = galerkin(1 + _i / EXCHANGE_CASES);
    tvi_system *plain, *exchanged_system;
    ck_assert_int_eq(tvi_system_potential(&plain, 2, c.mass, plain_potential, &c), TVI_OK);
    ck_assert_int_eq(tvi_system_hamiltonian(&exchanged_system, 2, exchanged_hamiltonian, &c), TVI_OK);
    tvi_integrator *it = integrator_of(plain, &options), *other = integrator_of(exchanged_system, &options);
    test_state x = {.t = 0.25}, y = {.t = 0.25};
    for (int i = 0; i < 2; i++) x.q[i] = c.q[i], x.p[i] = c.p[i], y.q[i] = c.p[i], y.p[i] = -c.q[i];
    go(it, c.h, 8, &x);
    go(other, c.h, 8, &y);
    for (int i = 0; i < 2; i++) {
        ck_assert_double_eq_tol(y.q[i], x.p[i], 2e-14);
        ck_assert_double_eq_tol(-y.p[i], x.q[i], 2e-14);
    }
    tvi_integrator_free(it);
    tvi_integrator_free(other);
    tvi_system_free(plain);
    tvi_system_free(exchanged_system);
}
END_TEST

/* ---- A field whose components are its inputs --------------------------------------------------------------------- */

/* F = (m q_1, m q_0): with m = 1 the coordinates themselves. All else doubles with m, bit for bit. */
static void saddle(const jet q[], jet t, jet force[], void *ctx)
{
    const double m = *(const double *)ctx;
    (void)t;
    for (int i = 0; i < 2; i++) force[i] = m == 1 ? q[1 - i] : jet_mul(m, q[1 - i]);
}

/* Passes that are far from the end, so that their order shows. */
START_TEST(field_may_be_its_input)
{
    tvi_options options = galerkin(3);
    options.passes = 2;
    test_state end[2];
    for (int k = 0; k < 2; k++) {
        double m = 1 + k, masses[] = {m, m};
        tvi_system *system;
        ck_assert_int_eq(tvi_system_force(&system, 2, masses, saddle, &m), TVI_OK);
        tvi_integrator *it = integrator_of(system, &options);
        end[k] = (test_state){.q = {1, 0.25}, .p = {-0.5 * m, 0.125 * m}};
        go(it, 0.5, 5, &end[k]);
        tvi_integrator_free(it);
        tvi_system_free(system);
    }
    for (int i = 0; i < 2; i++) {
        ck_assert_double_eq(end[0].q[i], end[1].q[i]);
        ck_assert_double_eq(2 * end[0].p[i], end[1].p[i]);
    }
}
END_TEST

/* H = p_0 p_1 + q_0 q_1: q_0' = p_1, p_1' = -q_0, a rotation; likewise (q_1, p_0). */
static jet crossed(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_mul(p[0], p[1]), jet_mul(q[0], q[1]));
}

START_TEST(hamiltonian_field_may_be_its_input)
{
    const tvi_options options = galerkin(8);
    tvi_system *system;
    ck_assert_int_eq(tvi_system_hamiltonian(&system, 2, crossed, NULL), TVI_OK);
    tvi_integrator *it = integrator_of(system, &options);
    test_state x = {.q = {1, 0.5}, .p = {0.25, -0.75}};
    go(it, 0.25, 8, &x);
    ck_assert_double_eq_tol(x.q[0], cos(2) - 0.75 * sin(2), 1e-14);
    ck_assert_double_eq_tol(x.p[1], -0.75 * cos(2) - sin(2), 1e-14);
    ck_assert_double_eq_tol(x.q[1], 0.5 * cos(2) + 0.25 * sin(2), 1e-14);
    ck_assert_double_eq_tol(x.p[0], 0.25 * cos(2) - 0.5 * sin(2), 1e-14);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* ---- The tail ---------------------------------------------------------------------------------------------------- */

/* t^power. */
static jet power_of(jet t, int power)
{
    jet product = jet_const(1);
    for (int i = 0; i < power; i++) product = jet_mul(product, t);
    return product;
}

static jet pushed(const jet q[], jet t, void *ctx) { return jet_neg(jet_mul(q[0], power_of(t, *(int *)ctx))); }
static jet carried(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q;
    return jet_mul(p[0], power_of(t, *(int *)ctx));
}

/* h k!^2 / (2k)! h^k: the last term, k = N - 1, of Legendre's series of t^k over a step of size h, times h. */
static double last_of_power(int k, double h)
{
    double last = h;
    for (int i = 1; i <= k; i++) last *= h * i / (2 * (2 * i - 1));
    return last;
}

/* The error for m q'' = t^k, relative to |p0| + |dp| + h (t_1^k + t_N^k), t_1 and t_N the first and the last node; of
 * q' = t^k relative to the last of the three. With one node there is no tail. */
START_TEST(tail_is_the_last_term)
{
    const int N = _i;
    int power = N - 1;
    const double mass = 2.5, h = 0.75, q0 = 4, p0 = -1, t0 = 1.25;
    long double s[TVI_MAX_NODES], b[TVI_MAX_NODES];
    tvi_quadrature_compute_nodes(TVI_GAUSS, N, s, b);
    const double ends = pow(t0 + h * (1 + (double)s[0]) / 2, power) + pow(t0 + h * (1 + (double)s[N - 1]) / 2, power);
    const double rise = (pow(t0 + h, N) - pow(t0, N)) / N, last = N > 1 ? last_of_power(power, h) : 0;
    const double want[] = {last / (fabs(p0) + rise + h * ends), last / (h * ends)};
    const tvi_options options = galerkin(N);
    tvi_system *systems[2];
    ck_assert_int_eq(tvi_system_potential(&systems[0], 1, &mass, pushed, &power), TVI_OK);
    ck_assert_int_eq(tvi_system_hamiltonian(&systems[1], 1, carried, &power), TVI_OK);
    for (int i = 0; i < 2; i++) {
        tvi_integrator *it = integrator_of(systems[i], &options);
        test_state x = {.t = t0, .q = {q0}, .p = {p0}};
        go(it, h, 1, &x);
        ck_assert_double_eq_tol(tvi_integrator_stats(it)->tail, want[i], 1e-6 * want[i] + 1e-13);
        tvi_integrator_free(it);
        tvi_system_free(systems[i]);
    }
}
END_TEST

Suite *suite_galerkin(void)
{
    Suite *suite = suite_create("galerkin");
    TCase *tcase = tcase_create("galerkin");
    tcase_add_loop_test(tcase, exchange_of_variables_changes_nothing, 0, EXCHANGE_CASES * TVI_MAX_NODES);
    tcase_add_test(tcase, field_may_be_its_input);
    tcase_add_test(tcase, hamiltonian_field_may_be_its_input);
    tcase_add_loop_test(tcase, tail_is_the_last_term, 1, TVI_MAX_NODES + 1);
    suite_add_tcase(suite, tcase);
    add_galerkin_passes(suite);
    return suite;
}
