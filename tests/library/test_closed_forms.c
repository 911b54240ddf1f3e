/* test_closed_forms.c - Tests what must come out to roundoff (docs/method.md section 7): methods of low degree that
 * have a closed form, identities of the curve's Jacobians, and the energies of section 9. */
#include "generating/curve.h"
#include "problems/problems.h"
#include "suites.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Steps by hand ----------------------------------------------------------------------------------------------- */

typedef void closed_form(const test_problem *problem, long double h, exact_state *x);

/* p += h F(q, t). */
static void kick(const test_problem *problem, long double h, long double t, exact_state *x)
{
    long double F[N_MAX];
    problem->plain(t, x->q, F);
    for (int i = 0; i < problem->scene->n; i++) x->p[i] += h * F[i];
}

/* q += h M^-1 p. */
static void drift(const test_problem *problem, long double h, exact_state *x)
{
    for (int i = 0; i < problem->scene->n; i++) x->q[i] += h / problem_mass(problem, i) * x->p[i];
}

/* p1 = p0 + h F(q0), q1 = q0 + h M^-1 p1. */
static void symplectic_euler_a(const test_problem *problem, long double h, exact_state *x)
{
    kick(problem, h, x->t, x);
    drift(problem, h, x);
    x->t += h;
}

/* q1 = q0 + h M^-1 p0, p1 = p0 + h F(q1). */
static void symplectic_euler_b(const test_problem *problem, long double h, exact_state *x)
{
    drift(problem, h, x);
    x->t += h;
    kick(problem, h, x->t, x);
}

static void stormer_verlet(const test_problem *problem, long double h, exact_state *x)
{
    kick(problem, h / 2, x->t, x);
    drift(problem, h, x);
    x->t += h;
    kick(problem, h / 2, x->t, x);
}

/* The corrected example 2 of the paper, F = -grad V (chain only, for its V''):
 *   q1 = q0 + h M^-1 p0 + h^2/2 M^-1 F0 - h^4/4 M^-1 V0'' M^-1 F0,  v = (q1 - q0)/h - h/2 M^-1 F0,
 *   p1 = M v + h/2 (F0 + F1). */
static void example_2(const test_problem *problem, long double h, exact_state *x)
{
    enum { n = 3 };
    long double F0[n], F1[n], H[n * n], q1[n];
    problem->plain(x->t, x->q, F0);
    chain_hessian(x->q, H);
    for (int i = 0; i < n; i++) {
        long double HF = 0;
        for (int j = 0; j < n; j++) HF += H[i * n + j] / problem_mass(problem, j) * F0[j];
        q1[i] = x->q[i] + (h * x->p[i] + h * h / 2 * F0[i] - powl(h, 4) / 4 * HF) / problem_mass(problem, i);
    }
    x->t += h;
    problem->plain(x->t, q1, F1);
    for (int i = 0; i < n; i++) {
        const long double Mv = problem_mass(problem, i) * (q1[i] - x->q[i]) / h - h / 2 * F0[i];
        x->p[i] = Mv + h / 2 * (F0[i] + F1[i]);
        x->q[i] = q1[i];
    }
}

/* Taylor of degree 2: q1 = q0 + h M^-1 p0 + h^2/2 M^-1 F0, p1 = p0 + h F0. */
static void taylor_2(const test_problem *problem, long double h, exact_state *x)
{
    drift(problem, h / 2, x);
    exact_state before = *x;
    drift(problem, -h / 2, x);
    kick(problem, h, x->t, x);
    memcpy(before.p, x->p, sizeof before.p);
    drift(problem, h / 2, &before);
    memcpy(x->q, before.q, sizeof x->q);
    x->t += h;
}

static const struct {
    tvi_method method;
    tvi_nodes nodes;
    int degree;
    tvi_quadrature quadrature;
    closed_form *step;
    bool chain_only;
} forms[] = {
    {TVI_TYPE1, TVI_NODES_TRUNCATED, 1, TVI_RECTANGLE_START, symplectic_euler_a, false},
    {TVI_TYPE1, TVI_NODES_ON_CURVE, 1, TVI_RECTANGLE_START, symplectic_euler_a, false},
    {TVI_TYPE1, TVI_NODES_TRUNCATED, 1, TVI_RECTANGLE_END, symplectic_euler_b, false},
    {TVI_TYPE1, TVI_NODES_ON_CURVE, 1, TVI_RECTANGLE_END, symplectic_euler_b, false},
    {TVI_TYPE1, TVI_NODES_TRUNCATED, 1, TVI_TRAPEZOID, stormer_verlet, false},
    {TVI_TYPE1, TVI_NODES_ON_CURVE, 1, TVI_TRAPEZOID, stormer_verlet, false},
    {TVI_TYPE1, TVI_NODES_TRUNCATED, 2, TVI_TRAPEZOID, example_2, true},
    {TVI_STORMER_VERLET, TVI_NODES_ON_CURVE, 1, TVI_QUADRATURE_AUTO, stormer_verlet, false},
    {TVI_TAYLOR, TVI_NODES_ON_CURVE, 2, TVI_QUADRATURE_AUTO, taylor_2, false},
};
enum { FORMS = sizeof forms / sizeof *forms };

static const test_problem *const form_problems[] = {&problem_chain, &problem_kepler, &problem_henon_heiles};
enum { FORM_PROBLEMS = sizeof form_problems / sizeof *form_problems };

static exact_state exact_start(const test_problem *problem)
{
    const test_state start = problem_start(problem);
    exact_state x = {.t = start.t};
    for (int i = 0; i < problem->scene->n; i++) x.q[i] = start.q[i], x.p[i] = start.p[i];
    return x;
}

/* One step and fifty, relative to the largest component. */
START_TEST(method_is_its_closed_form)
{
    const int form = _i % FORMS, n = form_problems[_i / FORMS]->scene->n;
    const test_problem *problem = form_problems[_i / FORMS];
    if (forms[form].chain_only && problem != &problem_chain) return;
    const double h = 0.0625;
    const tvi_options options = {.method = forms[form].method,
                                 .nodes = forms[form].nodes,
                                 .degree = forms[form].degree,
                                 .quadrature = forms[form].quadrature};
    runner run = runner_open(problem, &options);
    test_state state = problem_start(problem), zero = {0};
    exact_state exact = exact_start(problem);
    for (int step = 1; step <= 50; step++) {
        runner_steps(&run, h, 1, &state);
        forms[form].step(problem, h, &exact);
        const double size = larger(state_difference(n, &state, &zero)), error = larger(state_error(n, &state, &exact));
        ck_assert_msg(error < (step == 1 ? 1e-15 : 1e-14) * size, "form %d, %s, step %d: error %g of %g", form,
                      problem->scene->name, step, error, size);
    }
    runner_close(&run);
}
END_TEST

/* ---- The curve --------------------------------------------------------------------------------------------------- */

typedef struct {
    tvi_system *system;
    tvi_curve curve;
    void *memory;
} expansion;

static const double TAU = 0.375;

/* The curve of degree 4 from the start of the problem, with its Jacobians. */
static expansion expand(const test_problem *problem)
{
    const int n = problem->scene->n;
    expansion e = {.system = problem_system(problem)};
    tvi_arena arena = {0};
    tvi_curve_allocate(&e.curve, &arena, e.system, 4, true);
    e.memory = tvi_arena_obtain_memory(&arena);
    ck_assert_ptr_nonnull(e.memory);
    tvi_curve_allocate(&e.curve, &arena, e.system, 4, true);
    tvi_blocks_set_constants(arena.first_tape_block);
    tvi_curve_fill_tables(&e.curve);
    const test_state start = problem_start(problem);
    double z[2 * N_MAX];
    for (int i = 0; i < n; i++) {
        z[i] = start.q[i];
        z[n + i] = TAU * start.p[i] / problem_mass(problem, i);
    }
    curve_set_tau(&e.curve, TAU);
    curve_set_z(&e.curve, z);
    ck_assert_int_eq(tvi_curve_expand(&e.curve, start.t), TVI_OK);
    tvi_curve_compute_jacobians(&e.curve);
    return e;
}

static void release(expansion *e)
{
    tvi_system_free(e->system);
    free(e->memory);
}

/* dQ_k,i / dz_j, z = (Q_0, Q_1), Q_k = q^(k) tau^k / k!. */
static double derivative(const expansion *e, int k, int i, int j)
{
    const int n = e->curve.n;
    return e->curve.jacobians.dQ_dz[(k * n + i) * 2 * n + j];
}

/* dq^(4)/dv = 2 dq^(3)/dq and dq^(3)/dv = dq^(2)/dq for q'' = f(q, t); in scaled coefficients
 * 2 dQ_4/dQ_1 = dQ_3/dQ_0 and 3 dQ_3/dQ_1 = dQ_2/dQ_0. */
START_TEST(jacobians_share_columns)
{
    static const test_problem *const problems[] = {&problem_kepler, &problem_henon_heiles, &problem_chain,
                                                   &problem_fpu};
    expansion e = expand(problems[_i]);
    const int n = e.curve.n;
    double largest = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            const double of_q = derivative(&e, 3, i, j);
            ck_assert_double_eq_tol(2 * derivative(&e, 4, i, n + j), of_q, 1e-14 * fmax(1, fabs(of_q)));
            const double force = derivative(&e, 2, i, j);
            ck_assert_double_eq_tol(3 * derivative(&e, 3, i, n + j), force, 1e-14 * fmax(1, fabs(force)));
            largest = fmax(largest, fabs(of_q));
        }
    ck_assert_double_gt(largest, 1e-3);
    release(&e);
}
END_TEST

/* dQ_2/dQ_0 = -tau^2/2 M^-1 V''. */
START_TEST(second_jacobian_is_the_hessian)
{
    expansion e = expand(&problem_chain);
    const exact_state start = exact_start(&problem_chain);
    enum { n = 3 };
    long double H[n * n];
    chain_hessian(start.q, H);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            const double expected = (double)(-TAU * TAU / 2 / problem_mass(&problem_chain, i) * H[i * n + j]);
            ck_assert_double_eq_tol(derivative(&e, 2, i, j), expected, 1e-15);
            ck_assert_double_eq(derivative(&e, 2, i, n + j), 0);
        }
    release(&e);
}
END_TEST

/* ---- Energies and Legendre transforms ---------------------------------------------------------------------------- */

START_TEST(energies_are_those_of_section_9)
{
    static const struct {
        const test_problem *problem;
        double H0, relative;
    } rows[] = {
        {&problem_pendulum, 9.8, 1e-15},
        {&problem_kepler, -0.68, 1e-15},
        {&problem_henon_heiles, 1.0 / 12, 1e-15},
        {&problem_fpu, 2.00120008, 1e-15},
        {&problem_solar, -3.21545318320816e-8, 1e-13},
    };
    tvi_system *system = problem_system(rows[_i].problem);
    const test_state start = problem_start(rows[_i].problem);
    ck_assert_double_eq_tol(state_energy(system, &start), rows[_i].H0, rows[_i].relative * fabs(rows[_i].H0));
    tvi_system_free(system);
}
END_TEST

/* V = w^2/2 q_0^2 + sin(w t) q_1 with w = 1.5. */
static jet driven_potential(const jet q[], jet t, void *ctx)
{
    const double w = *(const double *)ctx;
    return jet_add(jet_mul(w * w / 2, jet_sqr(q[0])), jet_mul(jet_sin(jet_mul(w, t)), q[1]));
}

START_TEST(energy_and_legendre_transforms_have_masses_and_time)
{
    const double mass[] = {2, 0.25}, q[] = {1, -2}, p[] = {3, 0.5}, t = 0.7;
    double w = 1.5, H, v[2], back[2];
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 2, mass, driven_potential, &w), TVI_OK);
    w = 0; /* used only during the call */
    ck_assert_int_eq(tvi_energy(system, t, q, p, &H), TVI_OK);
    ck_assert_double_eq_tol(H, 9.0 / 4 + 0.25 / 0.5 + 1.125 - 2 * sin(1.5 * t), 1e-14);
    ck_assert_int_eq(tvi_velocity(system, t, q, p, v), TVI_OK);
    ck_assert_double_eq(v[0], 1.5);
    ck_assert_double_eq(v[1], 2);
    ck_assert_int_eq(tvi_momentum(system, t, q, v, back), TVI_OK);
    ck_assert_double_eq(back[0], p[0]);
    ck_assert_double_eq(back[1], p[1]);
    tvi_system_free(system);
}
END_TEST

/* A time-dependent potential and the same force give the same motion. */
static void driven_force(const jet q[], jet t, jet force[], void *ctx)
{
    const double w = *(const double *)ctx;
    force[0] = jet_mul(-w * w, q[0]);
    force[1] = jet_neg(jet_sin(jet_mul(w, t)));
}

START_TEST(potential_and_force_agree)
{
    const double mass[] = {2, 0.25};
    double w = 1.5, q[2][2] = {{1, -2}, {1, -2}}, p[2][2] = {{3, 0.5}, {3, 0.5}}, t[2] = {0.2, 0.2};
    tvi_system *system[2];
    ck_assert_int_eq(tvi_system_potential(&system[0], 2, mass, driven_potential, &w), TVI_OK);
    ck_assert_int_eq(tvi_system_force(&system[1], 2, mass, driven_force, &w), TVI_OK);
    for (int i = 0; i < 2; i++) {
        const tvi_options options = options_type1(TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 8);
        tvi_integrator *integrator;
        ck_assert_int_eq(tvi_integrator_create(&integrator, system[i], &options), TVI_OK);
        ck_assert_int_eq(tvi_integrate(integrator, 0.125, 16, &t[i], q[i], p[i], NULL, NULL), TVI_OK);
        tvi_integrator_free(integrator);
        tvi_system_free(system[i]);
    }
    /* q_0 = cos(W s) + 3/(2 W) sin(W s), W^2 = w^2/2, after s = 2; p_1 = 1/2 + (cos(w t) - cos(w t0))/w */
    const double W = w / sqrt(2), s = 2;
    ck_assert_double_eq_tol(q[0][0], cos(W * s) + 1.5 / W * sin(W * s), 1e-14);
    ck_assert_double_eq_tol(p[0][1], 0.5 + (cos(1.5 * 2.2) - cos(1.5 * 0.2)) / w, 1e-14);
    for (int i = 0; i < 2; i++) {
        ck_assert_double_eq_tol(q[0][i], q[1][i], 1e-14);
        ck_assert_double_eq_tol(p[0][i], p[1][i], 1e-14);
    }
}
END_TEST

Suite *suite_closed_forms(void)
{
    Suite *suite = suite_create("closed forms");
    TCase *tcase = tcase_create("closed forms");
    tcase_add_loop_test(tcase, method_is_its_closed_form, 0, FORMS * FORM_PROBLEMS);
    tcase_add_loop_test(tcase, jacobians_share_columns, 0, 4);
    tcase_add_test(tcase, second_jacobian_is_the_hessian);
    tcase_add_loop_test(tcase, energies_are_those_of_section_9, 0, 5);
    tcase_add_test(tcase, energy_and_legendre_transforms_have_masses_and_time);
    tcase_add_test(tcase, potential_and_force_agree);
    suite_add_tcase(suite, tcase);
    return suite;
}
