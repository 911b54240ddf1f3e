/* test_tail.c - Tests tvi_stats.tail: what it is, that it knows neither units nor an origin, that components which do
 * nothing do not raise it, and that it tells wrong steps from right ones. */
#include "loops.h"
#include "problems/problems.h"
#include "stability/cases.h"
#include "suites.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { FEW = 8 }; /* coordinates */

static const struct {
    const char *name;
    int order;
} methods[] = {{"galerkin", 16}, {"galerkin", 8}, {"midpoint", 12}, {"poincare", 12}, {"right", 10},    {"left", 10},
               {"start", 10},    {"end", 10},     {"tvi", 6},       {"taylor", 8},    {"both-ends", 10}};
enum { METHODS = sizeof methods / sizeof *methods };

typedef struct {
    double t, q[FEW], p[FEW];
} place;

static tvi_integrator *open_method(const tvi_system *system, int method)
{
    tvi_options options;
    tvi_integrator *it;
    ck_assert_int_eq(tvi_options_named(methods[method].name, methods[method].order, &options), TVI_OK);
    options.max_tail = -1;
    ck_assert_int_eq(tvi_integrator_create(&it, system, &options), TVI_OK);
    return it;
}

/* The tail of one step of size h; -1 for a step that fails. */
static double tail_of(const tvi_system *system, int method, double h, place x)
{
    tvi_integrator *it = open_method(system, method);
    const tvi_status status = tvi_step(it, h, &x.t, x.q, x.p);
    const double tail = status == TVI_OK ? tvi_integrator_stats(it)->tail : -1;
    tvi_integrator_free(it);
    return tail;
}

/* ---- What it is -------------------------------------------------------------------------------------------------- */

/* The Taylor curve of degree 3 from the start has p' = F + h F' s in scaled time, s = 1 at the end:
 * tail = |h^2 F'| / (|p| + |h F| + |h^2 F'|) of a component. F' along the motion by differences. */
START_TEST(tail_is_the_last_term)
{
    static const test_problem *const problems[] = {&problem_henon_heiles, &problem_kepler, &problem_chain};
    const test_problem *problem = problems[_i];
    const int n = problem->scene->n;
    const tvi_options options = options_taylor(3);
    test_state x = problem_start(problem);
    const double h = 0.05, d = 1e-4;
    long double q[N_MAX], F[3][N_MAX];
    double want = 0;
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < n; i++) q[i] = x.q[i] + (k - 1) * d * x.p[i] / problem_mass(problem, i);
        problem->plain(x.t + (k - 1) * d, q, F[k]);
    }
    for (int i = 0; i < n; i++) {
        const double last = fabs(h * h * (double)(F[2][i] - F[0][i]) / (2 * d));
        want = fmax(want, last / (fabs(x.p[i]) + fabs(h * (double)F[1][i]) + last));
    }
    runner run = runner_open(problem, &options);
    runner_steps(&run, h, 1, &x);
    ck_assert_double_eq_tol(tvi_integrator_stats(run.integrator)->tail, want, 1e-6 * want);
    runner_close(&run);
}
END_TEST

static jet carried(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)ctx;
    return jet_mul(p[0], jet_sqr(t));
}

/* q' = (1 + h s)^2 from t = 1, and p' = 0: the last of the terms 1, 2 h, h^2 of q'. */
START_TEST(tail_is_that_of_a_velocity)
{
    const tvi_options options = options_taylor(3);
    const double h = 0.25;
    place x = {.t = 1, .q = {3}, .p = {-2}};
    tvi_system *system;
    tvi_integrator *it;
    ck_assert_int_eq(tvi_system_hamiltonian(&system, 1, carried, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&it, system, &options), TVI_OK);
    ck_assert_int_eq(tvi_step(it, h, &x.t, x.q, x.p), TVI_OK);
    ck_assert_double_eq_tol(tvi_integrator_stats(it)->tail, h * h / pow(1 + h, 2), 1e-12);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* Forces of one term have no last one. */
START_TEST(lowest_degrees_have_no_tail)
{
    static const struct {
        const char *name;
        int order;
    } rows[] = {{"galerkin", 2}, {"midpoint", 2}, {"midpoint", 4},
                {"poincare", 4}, {"right", 4},    {"stormer-verlet", 2}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        tvi_options options;
        ck_assert_int_eq(tvi_options_named(rows[k].name, rows[k].order, &options), TVI_OK);
        runner run = runner_open(&problem_kepler, &options);
        test_state x = problem_start(&problem_kepler);
        runner_steps(&run, 0.05, 3, &x);
        ck_assert_double_eq(tvi_integrator_stats(run.integrator)->tail, 0);
        runner_close(&run);
    }
}
END_TEST

/* A composed step has the larger tail of its halves. */
START_TEST(composed_step_has_the_larger_tail)
{
    tvi_options options, halves[2];
    ck_assert_int_eq(tvi_options_named("start", 10, &options), TVI_OK);
    ck_assert_int_eq(tvi_options_named("end", 10, &halves[1]), TVI_OK);
    halves[0] = options;
    options.compose_adjoint = true;
    const double h = 0.5;
    runner run = runner_open(&problem_kepler, &options);
    test_state x = problem_start(&problem_kepler);
    x.p[0] = _i ? 0.5 : -0.5; /* outward, inward */
    test_state y = x;
    runner_steps(&run, h, 1, &x);
    double tail[2];
    for (int half = 0; half < 2; half++) {
        runner part = runner_open(&problem_kepler, &halves[half]);
        runner_steps(&part, h / 2, 1, &y);
        tail[half] = tvi_integrator_stats(part.integrator)->tail;
        runner_close(&part);
    }
    ck_assert(_i ? tail[0] > 1.1 * tail[1] : tail[1] > 1.1 * tail[0]);
    ck_assert_double_eq_tol(tvi_integrator_stats(run.integrator)->tail, fmax(tail[0], tail[1]), 1e-9 * tail[0]);
    runner_close(&run);
}
END_TEST

/* ---- What it does not depend on ---------------------------------------------------------------------------------- */

/* Two wells, V = -k / |x - x0|, in other units, elsewhere, and with coordinates exchanged. */
typedef struct {
    double length, time, mass, shift;
    bool is_exchanged;
} world;

static jet well(const jet q[], jet t, void *ctx)
{
    const world *w = ctx;
    (void)t;
    const jet x = jet_sub(q[0], w->shift), y = jet_sub(q[1], w->shift);
    const double k = w->mass * pow(w->length, 3) / pow(w->time, 2);
    return jet_mul(-k, jet_pow(jet_add(jet_sqr(x), jet_sqr(y)), -0.5));
}

static double tail_in(const world *w, int method, double h)
{
    const double q[] = {0.7, 0.4}, v[] = {-0.3, 0.9}, m[] = {1, 2.5};
    double mass[2];
    place x = {.t = 0};
    for (int i = 0; i < 2; i++) {
        const int k = w->is_exchanged ? 1 - i : i;
        mass[k] = w->mass * m[i];
        x.q[k] = w->length * q[i] + w->shift;
        x.p[k] = mass[k] * w->length / w->time * v[i];
    }
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 2, mass, well, (void *)w), TVI_OK);
    const double tail = tail_of(system, method, h * w->time, x);
    tvi_system_free(system);
    return tail;
}

START_TEST(tail_has_no_units_and_no_origin)
{
    static const world here = {1, 1, 1, 0, false};
    static const world others[] = {{1, 1, 1, 300, false}, {1, 1, 1, 0, true},      {1e-5, 1, 1, 0, false},
                                   {1, 1e4, 1, 0, false}, {1, 1, 1e-20, 0, false}, {3e7, 0.01, 1e6, 1e8, true}};
    const double tail = tail_in(&here, _i, 0.5);
    ck_assert(tail > 1e-8 && tail < 1);
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        ck_assert_double_eq_tol(tail_in(&others[k], _i, 0.5), tail, 1e-5 * tail);
}
END_TEST

/* H = (y^2 / (1 + x^2/3) + x^2 + ...)/2 of (x, y) = ((q - shift) / a, p / b), times a b: canonical changes of units. */
typedef struct {
    double a[2], b[2], shift;
} canonical;

static jet bead(const jet q[], const jet p[], jet t, void *ctx)
{
    const canonical *c = ctx;
    (void)t;
    const double unit = c->a[0] * c->b[0];
    jet x[2], y[2];
    for (int i = 0; i < 2; i++) {
        x[i] = jet_div(jet_sub(q[i], c->shift), c->a[i]);
        y[i] = jet_div(p[i], c->b[i]);
    }
    const jet motion = jet_add(jet_div(jet_sqr(y[0]), jet_add(1, jet_div(jet_sqr(x[0]), 3))), jet_sqr(y[1]));
    const jet place_of = jet_add(jet_sqr(x[0]), jet_mul(jet_sqr(x[1]), jet_add(1.5, x[0])));
    return jet_mul(unit / 2, jet_add(motion, place_of));
}

START_TEST(tail_has_no_canonical_units)
{
    static const canonical rows[] = {
        {{1, 1}, {1, 1}, 0}, {{1, 1}, {1, 1}, 200}, {{1e5, 1}, {1e-5, 1}, 0}, {{1e5, 1e-3}, {1e3, 1e11}, 0}};
    double tails[4];
    for (int k = 0; k < 4; k++) {
        place x = {.t = 0};
        const double q[] = {0.7, 0.4}, p[] = {-0.3, 0.9};
        for (int i = 0; i < 2; i++) {
            x.q[i] = rows[k].a[i] * q[i] + rows[k].shift;
            x.p[i] = rows[k].b[i] * p[i];
        }
        tvi_system *system;
        ck_assert_int_eq(tvi_system_hamiltonian(&system, 2, bead, (void *)&rows[k]), TVI_OK);
        tails[k] = tail_of(system, _i, 0.9, x);
        tvi_system_free(system);
        ck_assert(tails[k] > 1e-8 && tails[k] < 1);
        ck_assert_double_eq_tol(tails[k], tails[0], 1e-5 * tails[0]);
    }
}
END_TEST

/* ---- Components that do nothing ---------------------------------------------------------------------------------- */

/* A spring, and one about 1 that is at rest but for roundoff. */
static jet two_springs(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_mul(0.5, jet_sqr(q[0])), jet_mul(2, jet_sqr(jet_sub(q[1], 1))));
}

START_TEST(roundoff_has_no_tail)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 2, NULL, two_springs, NULL), TVI_OK);
    const place still = {.q = {0.5, 1}}, moving = {.q = {0.5, 1 + 4 * DBL_EPSILON}, .p = {0, DBL_EPSILON}};
    ck_assert_double_eq_tol(tail_of(system, _i, 0.5, moving), tail_of(system, _i, 0.5, still), 1e-12);
    tvi_system_free(system);
}
END_TEST

/* All that moves is roundoff: springs about 1. */
static jet far_spring(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_sqr(jet_sub(jet_exp(jet_sub(q[0], 1000)), 1)));
}

START_TEST(motion_of_roundoff_has_no_tail)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 1, NULL, far_spring, NULL), TVI_OK);
    for (int k = 0; k < 8; k++) {
        const place x = {.q = {1000 + k * 1.2e-13}, .p = {1e-14}};
        ck_assert_double_le(tail_of(system, _i, 0.5, x), 0);
    }
    tvi_system_free(system);
}
END_TEST

/* A chain at rest whose first mass is displaced: mass k begins to move like t^(2k). */
static jet chain(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet sum = jet_mul(0.5, jet_sqr(q[0]));
    for (int i = 1; i < FEW; i++) sum = jet_add(sum, jet_mul(0.5, jet_sqr(jet_sub(q[i], q[i - 1]))));
    return sum;
}

START_TEST(front_of_a_wave_has_no_tail)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, FEW, NULL, chain, NULL), TVI_OK);
    const place x = {.q = {0.5}};
    const double large = tail_of(system, _i, 0.2, x), small = tail_of(system, _i, 0.05, x);
    ck_assert(large >= 0 && large < 0.03);
    ck_assert(small >= 0 && small < 0.002);
    tvi_system_free(system);
}
END_TEST

/* ---- Wrong steps ------------------------------------------------------------------------------------------------- */

typedef struct {
    double energy, tail; /* largest error and largest tail */
} verdict;

static verdict run_to(const tvi_system *system, int method, double h, double t_end, place x)
{
    tvi_integrator *it = open_method(system, method);
    verdict v = {0, 0};
    double start, now;
    ck_assert_int_eq(tvi_energy(system, x.t, x.q, x.p, &start), TVI_OK);
    while (x.t < t_end - h / 2 && v.energy < 1e-2) {
        if (tvi_step(it, h, &x.t, x.q, x.p) != TVI_OK || tvi_energy(system, x.t, x.q, x.p, &now) != TVI_OK) break;
        v.tail = fmax(v.tail, tvi_integrator_stats(it)->tail);
        v.energy = fmax(v.energy, fabs(now / start - 1));
    }
    tvi_integrator_free(it);
    return v;
}

/* For "galerkin", energy errors above 1e-3 have tails above 0.01, those below 1e-6 have tails below 0.05
 * (docs/choosing.md); both kinds are there. */
static void judge(const tvi_system *system, int method, const double h[], int count, double t_end, place x)
{
    int wrong = 0, right = 0;
    for (int k = 0; k < count; k++) {
        const verdict v = run_to(system, method, h[k], t_end, x);
        if (v.energy > 1e-3) ck_assert_msg(v.tail > 0.01, "h = %g: error %g, tail %g", h[k], v.energy, v.tail);
        if (v.energy < 1e-6) ck_assert_msg(v.tail < 0.05, "h = %g: error %g, tail %g", h[k], v.energy, v.tail);
        wrong += v.energy > 1e-3;
        right += v.energy < 1e-6;
    }
    ck_assert(wrong > 0 && right > 0);
}

START_TEST(tail_tells_wrong_steps)
{
    static const double e[] = {0.6, 0.9, 0.99};
    tvi_system *system;
    ck_assert_int_eq(scene_system(&scene_kepler, &system), TVI_OK);
    for (int k = 0; k < 3; k++) {
        const place x = {.q = {1 + e[k], 0}, .p = {0, sqrt((1 - e[k]) / (1 + e[k]))}};
        double h[14];
        for (int i = 0; i < 14; i++) h[i] = ldexp(1.2, -i);
        judge(system, _i, h, 14, 10, x);
    }
    tvi_system_free(system);
}
END_TEST

START_TEST(tail_tells_a_pair_among_three)
{
    static const double h[] = {0.03, 0.01, 0.003, 0.001, 0.0002};
    place x = {.t = 0};
    tvi_system *system;
    ck_assert_int_eq(hard_system(&pythagorean, &system), TVI_OK);
    memcpy(x.q, pythagorean.scene.q, 6 * sizeof *x.q);
    judge(system, 0, h, 5, 70, x);
    tvi_system_free(system);
}
END_TEST

/* The share of the one with the largest ratio, the second, is 1e-6: a hundredth of the least one that counts; or all
 * that counts, where it knows none of the others. */
START_TEST(component_that_does_little_has_a_part_of_its_tail)
{
    const int n = 2 + _i / 2;
    const bool is_alone = _i % 2 == 1;
    int member[] = {1, 0, 2, 3, 4}, end[] = {1, n};
    double scale[8], inverse_scale[8], zero[8] = {0}, p[8], last[8], share[8], ratio[8], tail;
    for (int i = 0; i < n; i++) scale[i] = inverse_scale[i] = p[i] = 1, last[i] = 1e-4;
    p[1] = 1e-3, last[1] = 5e-4;
    const galerkin_tail of = {.n = n,
                              .is_separable = true,
                              .has_masses = true,
                              .subsystems = {1 + is_alone, member, end + !is_alone},
                              .sums = {.last_term = last, .ends = zero},
                              .scale = scale,
                              .inverse_scale = inverse_scale,
                              .q = zero,
                              .p = p,
                              .dp = zero,
                              .share = share,
                              .ratio = ratio};
    tail = loops.compute_tail(&of);
    ck_assert_double_eq_tol(tail, is_alone ? 0.5 : 5e-3, 1e-15);
}
END_TEST

Suite *suite_tail(void)
{
    Suite *suite = suite_create("tail");
    TCase *tcase = tcase_create("tail");
    tcase_add_loop_test(tcase, tail_is_the_last_term, 0, 3);
    tcase_add_test(tcase, tail_is_that_of_a_velocity);
    tcase_add_test(tcase, lowest_degrees_have_no_tail);
    tcase_add_loop_test(tcase, composed_step_has_the_larger_tail, 0, 2);
    tcase_add_loop_test(tcase, tail_has_no_units_and_no_origin, 0, METHODS);
    tcase_add_loop_test(tcase, tail_has_no_canonical_units, 0, METHODS);
    tcase_add_loop_test(tcase, roundoff_has_no_tail, 0, METHODS);
    tcase_add_loop_test(tcase, motion_of_roundoff_has_no_tail, 0, METHODS);
    tcase_add_loop_test(tcase, front_of_a_wave_has_no_tail, 0, METHODS);
    tcase_add_loop_test(tcase, tail_tells_wrong_steps, 0, 2);
    tcase_add_test(tcase, tail_tells_a_pair_among_three);
    tcase_add_loop_test(tcase, component_that_does_little_has_a_part_of_its_tail, 0, 8);
    suite_add_tcase(suite, tcase);
    return suite;
}
