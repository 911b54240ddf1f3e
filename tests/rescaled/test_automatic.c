/* test_automatic.c - Tests the automatic time scale of Hamiltonians in which momenta and coordinates mix: it is
 * positive, and its steps are right or refused, also where frequencies are complex or a coordinate is cyclic. */
#include "problems/refusals.h"
#include "rescaled.h"

#include <math.h>
#include <string.h>

/* ---- The table --------------------------------------------------------------------------------------------------- */

static double parameter; /* mu, B^2 / k or e */

static jet restricted(const jet q[], const jet p[], jet t, void *ctx)
{
    const double mu = parameter;
    (void)t, (void)ctx;
    const jet yy = jet_sqr(q[1]), V = jet_add(jet_mul(mu - 1, jet_pow(jet_add(jet_sqr(jet_add(q[0], mu)), yy), -0.5)),
                                              jet_mul(-mu, jet_pow(jet_add(jet_sqr(jet_sub(q[0], 1 - mu)), yy), -0.5)));
    const jet turn = jet_sub(jet_mul(q[1], p[0]), jet_mul(q[0], p[1]));
    return jet_add(jet_add(jet_mul(0.5, jet_dot(p, p, 2)), turn), V);
}

/* k = 1. */
static jet charge_on_a_hill(const jet q[], const jet p[], jet t, void *ctx)
{
    const double half = sqrt(parameter) / 2;
    (void)t, (void)ctx;
    const jet x = jet_add(p[0], jet_mul(half, q[1])), y = jet_sub(p[1], jet_mul(half, q[0]));
    return jet_mul(0.5, jet_sub(jet_add(jet_sqr(x), jet_sqr(y)), jet_dot(q, q, 2)));
}

static jet polar(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_mul(0.5, jet_add(jet_sqr(p[0]), jet_sqr(jet_div(p[1], q[0])))), jet_div(1, q[0]));
}

static jet spherical(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet turning = jet_add(jet_sqr(p[1]), jet_sqr(jet_div(p[2], jet_sin(q[1]))));
    return jet_sub(jet_mul(0.5, jet_add(jet_sqr(p[0]), jet_div(turning, jet_sqr(q[0])))), jet_div(1, q[0]));
}

static jet henon_heiles(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet cubic = jet_mul(q[1], jet_sub(jet_sqr(q[0]), jet_div(jet_sqr(q[1]), 3)));
    return jet_add(jet_mul(0.5, jet_add(jet_dot(p, p, 2), jet_dot(q, q, 2))), cubic);
}

/* Masses, lengths and gravity 1. */
static jet double_pendulum(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet apart = jet_sub(q[0], q[1]), mixed = jet_mul(jet_cos(apart), jet_mul(p[0], p[1]));
    const jet square = jet_sub(jet_add(jet_sqr(p[0]), jet_mul(2, jet_sqr(p[1]))), jet_mul(2, mixed));
    const jet V = jet_sub(jet_mul(-2, jet_cos(q[0])), jet_cos(q[1]));
    return jet_add(jet_div(square, jet_mul(2, jet_add(1, jet_sqr(jet_sin(apart))))), V);
}

static state near_l4(double mu) { return (state){0, {0.5 - mu, 0.9}, {-0.9, 0.5 - mu}}; }
static state near_the_light_one(double mu) { return (state){0, {1 - mu + 0.2, 0}, {0, 1.2 - mu + sqrt(mu / 0.2)}}; }
static state on_the_hill(double ratio)
{
    (void)ratio;
    return (state){0, {0.3, -0.1}, {0.2, 0.4}};
}
static state at_pericentre(double e) { return (state){0, {1 - e, 0}, {0, sqrt((1 - e) * (1 + e))}}; }
static state tilted(double e)
{
    const double L = sqrt((1 - e) * (1 + e)), tilt = 1, equator = acos(-1) / 2;
    return (state){0, {1 - e, equator, 0}, {0, -L * sin(tilt), L * cos(tilt)}};
}
static state chaotic(double not_used)
{
    (void)not_used;
    return (state){0, {0, -0.25}, {0.42081, 0}};
}
static state thrown_up(double angle) { return (state){0, {angle, angle + 0.5}, {0, 0}}; }

typedef struct {
    int n;
    tvi_hamiltonian_fn *H;
    state (*start)(double);
    double parameters[8];
    int count;
} row;

static const row rows[] = {
    {2, restricted, near_l4, {0.01, 0.0121506, 0.0385, 0.08, 0.1, 0.2, 0.3, 0.5}, 8},
    {2, restricted, near_the_light_one, {0.01, 0.0121506, 0.0385, 0.08, 0.1, 0.2, 0.3, 0.5}, 8},
    {2, charge_on_a_hill, on_the_hill, {0.1, 0.5, 1, 2, 3.99, 4, 4.01, 10}, 8},
    {2, polar, at_pericentre, {0, 0.1, 0.3, 0.45, 0.6, 0.8, 0.9, 0.99}, 8},
    {3, spherical, tilted, {0, 0.1, 0.3, 0.45, 0.6, 0.8, 0.9, 0.99}, 8},
    {2, henon_heiles, chaotic, {0}, 1},
    {2, double_pendulum, thrown_up, {0.1, 1, 1.5708, 2, 3}, 5},
};
enum { ROWS = sizeof rows / sizeof *rows, STEPS = 150, PARTS = 8 };
static const double SIZE = 0.3;

static double largest(int n, const state *x)
{
    double most = 0;
    for (int i = 0; i < n; i++) most = fmax(most, fmax(fabs(x->q[i]), fabs(x->p[i])));
    return most;
}

/* Each step from the solution, beside it: right to 1e-3, or refused. The refused ones. */
static int refused_steps(tvi_system *system, const state *start)
{
    run once = open_run(system, NULL, 0, start), in_parts = open_run(system, NULL, 0, start);
    const int n = tvi_system_dimension(system);
    int failed = 0;
    for (int step = 0; step < STEPS; step++) {
        const double g = scale_at(system, &in_parts.x);
        ck_assert(g > 0 && isfinite(g));
        once.x = in_parts.x;
        const tvi_status status = run_steps(&once, SIZE, 1);
        ck_assert_int_eq(run_steps(&in_parts, SIZE / PARTS, PARTS), TVI_OK);
        if (status != TVI_OK) failed++;
        else ck_assert_double_le(state_distance(n, &once.x, &in_parts.x), 1e-3 * largest(n, &in_parts.x));
    }
    tvi_integrator_free(once.integrator);
    tvi_integrator_free(in_parts.integrator);
    return failed;
}

START_TEST(positive_and_right)
{
    const row *r = &rows[_i];
    for (int k = 0; k < r->count; k++) {
        const state start = r->start(r->parameters[k]);
        parameter = r->parameters[k];
        tvi_system *system = rescaled_hamiltonian(r->n, r->H, NULL);
        const int failed = refused_steps(system, &start);
        ck_assert_int_le(failed, r->H == double_pendulum ? STEPS / 5 : 0);
        tvi_system_free(system);
    }
}
END_TEST

/* ---- Closed forms ------------------------------------------------------------------------------------------------ */

static const state somewhere = {0.3, {0.7, 0.2, -0.4}, {-0.3, 0.5, 0.2}};

/* q = r, theta: D_rr = L^2 / r^4 + 2 / r^3, tr C^2 = -8 L^2 / r^4. */
START_TEST(of_polar_coordinates)
{
    tvi_system *system = rescaled_hamiltonian(2, polar, NULL);
    for (int k = 1; k < 20; k++) {
        const double r = 0.2 * k, L = 0.8, turning = L * L / pow(r, 4);
        const state x = {0, {r, 1}, {0.3, L}};
        const double expected = pow(pow(turning + 2 / pow(r, 3), 2) + 16 * turning * turning, -0.25);
        ck_assert_double_eq_tol(scale_at(system, &x) / expected, 1, 1e-14);
    }
    tvi_system_free(system);
}
END_TEST

/* Two harmonic directions of the hill, k = 1, and the field: 2 k^2 + B^4. */
START_TEST(of_a_charge)
{
    for (int k = 0; k < 8; k++) {
        parameter = 0.1 * pow(2, k);
        tvi_system *system = rescaled_hamiltonian(2, charge_on_a_hill, NULL);
        ck_assert_double_eq_tol(scale_at(system, &somewhere), pow(2 + parameter * parameter, -0.25), 1e-15);
        tvi_system_free(system);
    }
}
END_TEST

/* Frequencies 2 and -1/2, q = Q + (0, 2; 2, 0) p, p = P + (1/2, 1; 1, -1/4) Q: H_pp = diag(0, 15/2). */
static jet degenerate(const jet Q[], const jet P[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet p[2] = {jet_add(P[0], jet_add(jet_mul(0.5, Q[0]), Q[1])),
                      jet_add(P[1], jet_sub(Q[0], jet_mul(0.25, Q[1])))};
    const jet q[2] = {jet_add(Q[0], jet_mul(2, p[1])), jet_add(Q[1], jet_mul(2, p[0]))};
    const jet first = jet_add(jet_sqr(q[0]), jet_sqr(p[0])), second = jet_add(jet_sqr(q[1]), jet_sqr(p[1]));
    return jet_sub(first, jet_mul(0.25, second));
}

START_TEST(of_a_degenerate_one)
{
    tvi_system *system = rescaled_hamiltonian(2, degenerate, NULL);
    ck_assert_double_eq_tol(scale_at(system, &somewhere), pow(16 + 1.0 / 16, -0.25), 1e-14);
    tvi_system_free(system);
}
END_TEST

/* ---- Other coordinates, momenta and units ------------------------------------------------------------------------ */

/* q = Q S length, p = S^-T P mass length / time + M q, t in the unit of time. */
typedef struct {
    double S[3][3], inverse[3][3], M[3][3], length, mass, time;
} frame;

/* All of H'' depends on the state, and H_pp is definite there. */
static jet general(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet T[] = {jet_mul(jet_add(1, jet_sqr(q[1])), jet_sqr(p[0])),
                     jet_mul(jet_add(2, jet_sin(q[0])), jet_sqr(p[1])),
                     jet_mul(3, jet_sqr(p[2])),
                     jet_mul(q[2], jet_mul(p[0], p[1])),
                     jet_mul(jet_cos(q[1]), jet_mul(p[1], p[2])),
                     jet_mul(0.5, jet_mul(p[0], p[2]))};
    const jet rest[] = {jet_mul(p[0], jet_mul(q[1], q[2])), jet_neg(jet_mul(p[2], jet_sqr(q[0]))),
                        jet_mul(p[1], jet_exp(q[2])), jet_mul(0.25, jet_sqr(jet_dot(q, q, 3))), jet_mul(q[0], q[1])};
    return jet_add(jet_mul(0.5, jet_sum(T, 6)), jet_sum(rest, 5));
}

static jet combination(const double x[3], const jet y[])
{
    const jet terms[] = {jet_mul(x[0], y[0]), jet_mul(x[1], y[1]), jet_mul(x[2], y[2])};
    return jet_sum(terms, 3);
}

static jet general_in(const jet Q[], const jet P[], jet t, void *ctx)
{
    const frame *f = ctx;
    jet q[3], p[3];
    for (int i = 0; i < 3; i++) q[i] = jet_mul(f->length, combination(f->S[i], Q));
    for (int i = 0; i < 3; i++) {
        const double column[] = {f->inverse[0][i], f->inverse[1][i], f->inverse[2][i]};
        p[i] = jet_add(jet_mul(f->mass * f->length / f->time, combination(column, P)), combination(f->M[i], q));
    }
    return jet_mul(f->time * f->time / (f->mass * f->length * f->length), general(q, p, t, NULL));
}

/* The position of x in the frame. */
static state in_frame(const frame *f, const state *x)
{
    state X = {.t = x->t};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double less = x->p[j];
            for (int k = 0; k < 3; k++) less -= f->M[j][k] * x->q[k];
            X.q[i] += f->inverse[i][j] * x->q[j] / f->length;
            X.p[i] += f->S[j][i] * less * f->time / (f->mass * f->length);
        }
    return X;
}

#define UNIT                                                                                                           \
    {                                                                                                                  \
        {1, 0, 0}, {0, 1, 0}, { 0, 0, 1 }                                                                              \
    }
#define NONE                                                                                                           \
    {                                                                                                                  \
        {0, 0, 0}, {0, 0, 0}, { 0, 0, 0 }                                                                              \
    }
#define OBLIQUE                                                                                                        \
    {{1, 2, 0}, {0, 1, -1}, {3, 0, 2}},                                                                                \
    {                                                                                                                  \
        {-0.5, 1, 0.5}, {0.75, -0.5, -0.25}, { 0.75, -1.5, -0.25 }                                                     \
    }
#define GAUGE                                                                                                          \
    {                                                                                                                  \
        {0.5, 2, -1}, {2, -3, 0.25}, { -1, 0.25, 1.5 }                                                                 \
    }
static const frame frames[] = {
    {UNIT, UNIT, NONE, 7, 1, 1},  {UNIT, UNIT, NONE, 1, 0.3, 1}, {UNIT, UNIT, NONE, 1, 1, 86400},
    {UNIT, UNIT, GAUGE, 1, 1, 1}, {OBLIQUE, NONE, 1, 1, 1},      {OBLIQUE, GAUGE, 1e-11, 1e30, 3e7},
    {UNIT, UNIT, NONE, 1, 1, -1},
};
enum { FRAMES = sizeof frames / sizeof *frames };

START_TEST(does_not_depend_on_the_frame)
{
    const frame *f = &frames[_i];
    tvi_system *plain = rescaled_hamiltonian(3, general, NULL), *other = rescaled_hamiltonian(3, general_in, (void *)f);
    for (int k = 0; k < 20; k++) {
        state x = somewhere;
        for (int i = 0; i < 3; i++) x.q[i] += 0.3 * sin(k + 2 * i), x.p[i] += cos(3 * k + i);
        const state X = in_frame(f, &x);
        ck_assert_double_eq_tol(scale_at(other, &X) * fabs(f->time) / scale_at(plain, &x), 1, 2e-13);
    }
    tvi_system_free(plain);
    tvi_system_free(other);
}
END_TEST

/* ---- Where there is none ----------------------------------------------------------------------------------------- */

static jet indefinite(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *curved = ctx;
    (void)t;
    const jet T = jet_mul(0.5, jet_sub(jet_sqr(p[0]), jet_sqr(p[1])));
    return jet_add(T, jet_mul(q[0], jet_mul(q[1], jet_add(1, jet_mul(*curved, q[0])))));
}

/* By the system where g has no value anywhere, else by the step, which names it. */
START_TEST(is_refused_by_name)
{
    double curved = 0;
    tvi_system *base, *system;
    ck_assert_int_eq(tvi_system_hamiltonian(&base, 2, indefinite, &curved), TVI_OK);
    refused("the automatic g has no value (give a g of your own): ", tvi_system_rescaled(&system, base, NULL, NULL),
            TVI_EDOMAIN);
    ck_assert_ptr_null(system);
    tvi_system_free(base);
    curved = 0.1;
    run r = open_run(rescaled_hamiltonian(2, indefinite, &curved), NULL, 0, &somewhere);
    refused("the automatic g, which has no value there (take a smaller step, or give a g of your own): ",
            run_steps(&r, 0.1, 1), TVI_EDOMAIN);
    ck_assert(memcmp(&r.x, &somewhere, sizeof r.x) == 0);
    close_run(&r);
}
END_TEST

/* A weak cusp, 1e-3 wide: the body is through in less than a hundredth of the time that V_qq tells. */
static jet cusp(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet square = jet_dot(q, q, 2), r = jet_sqrt(jet_add(square, 1e-6));
    return jet_sub(jet_mul(0.5, square), jet_mul(0.1, jet_div(jet_log(jet_add(1, r)), r)));
}

START_TEST(is_too_large_for_what_it_does_not_see)
{
    const state start = {0, {1, 0}, {0, 1e-3}};
    run r = open_run(rescaled_system(2, NULL, cusp, NULL), NULL, 0, &start);
    double before, after;
    ck_assert_int_eq(tvi_energy(r.system, 0, r.x.q, r.x.p, &before), TVI_OK);
    refused("above max_tail = 0.03125: the automatic g is too large here (give a g of your own)",
            run_steps(&r, 1.0 / 3, 600), TVI_ETOOLARGE);
    ck_assert_int_eq(tvi_energy(r.system, 0, r.x.q, r.x.p, &after), TVI_OK);
    ck_assert_double_eq_tol(after, before, 1e-3 * fabs(before));
    close_run(&r);
}
END_TEST

/* The tail of the seventh step is 0.09, between that bound and TVI_MAX_TAIL, which the user may ask for. */
START_TEST(its_bound_is_of_options_that_have_none)
{
    static const double bounds[] = {0, TVI_MAX_TAIL, -1};
    for (int i = 0; i < 3; i++) {
        tvi_system *system = rescaled_system(2, NULL, cusp, NULL);
        tvi_options options = tvi_options_default();
        tvi_integrator *integrator;
        state x = {0, {1, 0}, {0, 1e-3}};
        options.max_tail = bounds[i];
        ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
        const tvi_status status = tvi_integrate(integrator, 1.0 / 3, 7, &x.t, x.q, x.p, NULL, NULL);
        ck_assert_int_eq(status, bounds[i] == 0 ? TVI_ETOOLARGE : TVI_OK);
        tvi_integrator_free(integrator);
        tvi_system_free(system);
    }
}
END_TEST

Suite *suite_automatic(void)
{
    Suite *suite = suite_create("automatic");
    TCase *table = tcase_create("table"), *forms = tcase_create("forms"), *refusals = tcase_create("refusals");
    tcase_add_loop_test(table, positive_and_right, 0, ROWS);
    suite_add_tcase(suite, table);
    tcase_add_test(forms, of_polar_coordinates);
    tcase_add_test(forms, of_a_charge);
    tcase_add_test(forms, of_a_degenerate_one);
    tcase_add_loop_test(forms, does_not_depend_on_the_frame, 0, FRAMES);
    suite_add_tcase(suite, forms);
    tcase_add_test(refusals, is_refused_by_name);
    tcase_add_test(refusals, is_too_large_for_what_it_does_not_see);
    tcase_add_test(refusals, its_bound_is_of_options_that_have_none);
    suite_add_tcase(suite, refusals);
    return suite;
}
