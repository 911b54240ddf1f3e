/* test_forms.c - Tests the closed forms of docs/method.md section 7: methods of the lowest degree written down with H_q
 * and H_p. */
#include "generating.h"
#include "models.h"

#include <math.h>

/* ---- H_q and H_p by hand ----------------------------------------------------------------------------------------- */

typedef struct {
    long double q[N_MAX], p[N_MAX];
} slopes;

static slopes slopes_at(const model *m, long double t, const long double q[], const long double p[])
{
    slopes H = {{0}, {0}};
    if (m == &model_nonseparable) {
        H.q[0] = q[0] * (p[0] * p[0] + 1);
        H.p[0] = (q[0] * q[0] + 1) * p[0];
    } else if (m == &model_degenerate) {
        H.q[0] = p[0] * cosl(q[0]) - sinl(q[0]);
        H.p[0] = sinl(q[0]);
    } else {
        m->problem->plain(t, q, H.q);
        for (int i = 0; i < m->n; i++) {
            H.q[i] = -H.q[i];
            H.p[i] = p[i] / problem_mass(m->problem, i);
        }
    }
    return H;
}

/* ---- Steps by hand ----------------------------------------------------------------------------------------------- */

typedef void closed_form(const model *m, long double h, exact_state *x);

enum { ITERATIONS = 120 }; /* of fixed points that contract by h */

/* q1 = q0 + h H_p(q0, p1), p1 = p0 - h H_q(q0, p1), at t0. */
static void symplectic_euler_a(const model *m, long double h, exact_state *x)
{
    exact_state end = *x;
    for (int pass = 0; pass < ITERATIONS; pass++) {
        const slopes H = slopes_at(m, x->t, x->q, end.p);
        for (int i = 0; i < m->n; i++) end.p[i] = x->p[i] - h * H.q[i], end.q[i] = x->q[i] + h * H.p[i];
    }
    end.t += h;
    *x = end;
}

/* q1 = q0 + h H_p(q1, p0), p1 = p0 - h H_q(q1, p0), at t1. */
static void symplectic_euler_b(const model *m, long double h, exact_state *x)
{
    exact_state end = *x;
    end.t += h;
    for (int pass = 0; pass < ITERATIONS; pass++) {
        const slopes H = slopes_at(m, end.t, end.q, x->p);
        for (int i = 0; i < m->n; i++) end.p[i] = x->p[i] - h * H.q[i], end.q[i] = x->q[i] + h * H.p[i];
    }
    *x = end;
}

/* The slopes at the mean of the ends. */
static void implicit_midpoint(const model *m, long double h, exact_state *x)
{
    exact_state end = *x, mean;
    end.t += h;
    for (int pass = 0; pass < ITERATIONS; pass++) {
        for (int i = 0; i < m->n; i++) mean.q[i] = (x->q[i] + end.q[i]) / 2, mean.p[i] = (x->p[i] + end.p[i]) / 2;
        const slopes H = slopes_at(m, x->t + h / 2, mean.q, mean.p);
        for (int i = 0; i < m->n; i++) end.p[i] = x->p[i] - h * H.q[i], end.q[i] = x->q[i] + h * H.p[i];
    }
    *x = end;
}

/* Half a kick, a drift, half a kick. Separable. */
static void stormer_verlet(const model *m, long double h, exact_state *x)
{
    symplectic_euler_a(m, h / 2, x);
    symplectic_euler_b(m, h / 2, x);
}

/* Type II at the start with the rectangle at the end, separable: Q = q0 + h M^-1 p1,
 * p1 = p0 + h F(Q), q1 = q0 + h M^-1 p0. Not symplectic Euler B (section 8.6). */
static void right_with_end(const model *m, long double h, exact_state *x)
{
    exact_state end = *x;
    end.t += h;
    for (int pass = 0; pass < ITERATIONS; pass++) {
        const slopes drift = slopes_at(m, end.t, x->q, end.p);
        for (int i = 0; i < m->n; i++) end.q[i] = x->q[i] + h * drift.p[i];
        const slopes kick = slopes_at(m, end.t, end.q, x->p);
        for (int i = 0; i < m->n; i++) end.p[i] = x->p[i] - h * kick.q[i], end.q[i] = x->q[i] + h * kick.p[i];
    }
    *x = end;
}

/* Type III at the start with the rectangle there, separable: w - h^2 M^-1 F(w) = q0, p1 = p0 + h F(w), q1 = q0 + h M^-1
 * p1. */
static void left_with_start(const model *m, long double h, exact_state *x)
{
    exact_state end = *x;
    long double w[N_MAX];
    for (int i = 0; i < m->n; i++) w[i] = x->q[i];
    for (int pass = 0; pass < ITERATIONS; pass++) {
        const slopes kick = slopes_at(m, x->t, w, x->p);
        for (int i = 0; i < m->n; i++) end.p[i] = x->p[i] - h * kick.q[i];
        const slopes before = slopes_at(m, x->t, w, x->p), after = slopes_at(m, x->t, w, end.p);
        for (int i = 0; i < m->n; i++) {
            w[i] = x->q[i] + h * (after.p[i] - before.p[i]);
            end.q[i] = x->q[i] + h * after.p[i];
        }
    }
    end.t += h;
    *x = end;
}

/* Phi of SVHd, separable: Q = q0 + k M^-1 p1, p1 = p0 + k/2 (F(q0) + F(Q)), q1 = Q - k^2/2 M^-1 F(Q). */
static void svhd_first(const model *m, long double k, exact_state *x)
{
    exact_state end = *x;
    const slopes here = slopes_at(m, x->t, x->q, x->p);
    end.t += k;
    for (int pass = 0; pass < ITERATIONS; pass++) {
        long double Q[N_MAX], kicked[N_MAX];
        const slopes drift = slopes_at(m, end.t, x->q, end.p);
        for (int i = 0; i < m->n; i++) Q[i] = x->q[i] + k * drift.p[i];
        const slopes there = slopes_at(m, end.t, Q, end.p);
        for (int i = 0; i < m->n; i++) {
            end.p[i] = x->p[i] - k / 2 * (here.q[i] + there.q[i]);
            kicked[i] = end.p[i] + k / 2 * there.q[i]; /* q1 = q0 + k M^-1 (p1 - k/2 F(Q)) */
        }
        const slopes last = slopes_at(m, end.t, Q, kicked);
        for (int i = 0; i < m->n; i++) end.q[i] = x->q[i] + k * last.p[i];
    }
    *x = end;
}

/* Phi* of SVHd, separable: Q - k^2/2 M^-1 F(Q) = q0, q1 = Q + k M^-1 p0, p1 = p0 + k/2 (F(Q) + F(q1)). */
static void svhd_second(const model *m, long double k, exact_state *x)
{
    exact_state end = *x;
    long double Q[N_MAX], zero[N_MAX] = {0}, kicked[N_MAX];
    for (int i = 0; i < m->n; i++) Q[i] = x->q[i];
    for (int pass = 0; pass < ITERATIONS; pass++) {
        const slopes here = slopes_at(m, x->t, Q, zero);
        for (int i = 0; i < m->n; i++) kicked[i] = -k / 2 * here.q[i];
        const slopes shift = slopes_at(m, x->t, Q, kicked);
        for (int i = 0; i < m->n; i++) Q[i] = x->q[i] + k * shift.p[i];
    }
    const slopes here = slopes_at(m, x->t, Q, x->p);
    for (int i = 0; i < m->n; i++) end.q[i] = Q[i] + k * here.p[i];
    end.t += k;
    const slopes there = slopes_at(m, end.t, end.q, x->p);
    for (int i = 0; i < m->n; i++) end.p[i] = x->p[i] - k / 2 * (here.q[i] + there.q[i]);
    *x = end;
}

static void svhd(const model *m, long double h, exact_state *x)
{
    svhd_first(m, h / 2, x);
    svhd_second(m, h / 2, x);
}

/* ---- What is what ------------------------------------------------------------------------------------------------ */

enum { SEPARABLE_ONLY = 0, ANY = 1 };

static const struct {
    tvi_method method;
    tvi_expansion expansion;
    tvi_nodes nodes;
    tvi_quadrature quadrature;
    int points;
    closed_form *step;
    int systems;
} forms[] = {
    {TVI_TYPE2, TVI_AT_START, TVI_NODES_TRUNCATED, TVI_RECTANGLE_START, 1, symplectic_euler_a, ANY},
    {TVI_TYPE2, TVI_AT_START, TVI_NODES_ON_CURVE, TVI_RECTANGLE_START, 1, symplectic_euler_a, ANY},
    {TVI_TYPE2, TVI_AT_END, TVI_NODES_ON_CURVE, TVI_RECTANGLE_START, 1, symplectic_euler_a, ANY},
    {TVI_TYPE2, TVI_AT_END, TVI_NODES_TRUNCATED, TVI_RECTANGLE_START, 1, symplectic_euler_a, SEPARABLE_ONLY},
    {TVI_TYPE3, TVI_AT_END, TVI_NODES_TRUNCATED, TVI_RECTANGLE_END, 1, symplectic_euler_b, ANY},
    {TVI_TYPE3, TVI_AT_END, TVI_NODES_ON_CURVE, TVI_RECTANGLE_END, 1, symplectic_euler_b, ANY},
    {TVI_TYPE3, TVI_AT_START, TVI_NODES_ON_CURVE, TVI_RECTANGLE_END, 1, symplectic_euler_b, ANY},
    {TVI_TYPE3, TVI_AT_START, TVI_NODES_TRUNCATED, TVI_RECTANGLE_END, 1, symplectic_euler_b, SEPARABLE_ONLY},
    {TVI_TYPE1, TVI_AT_START, TVI_NODES_TRUNCATED, TVI_RECTANGLE_START, 1, symplectic_euler_a, SEPARABLE_ONLY},
    {TVI_TYPE1, TVI_AT_END, TVI_NODES_TRUNCATED, TVI_RECTANGLE_END, 1, symplectic_euler_b, SEPARABLE_ONLY},
    {TVI_TYPE2, TVI_AT_START, TVI_NODES_TRUNCATED, TVI_RECTANGLE_END, 1, right_with_end, SEPARABLE_ONLY},
    {TVI_TYPE3, TVI_AT_START, TVI_NODES_TRUNCATED, TVI_RECTANGLE_START, 1, left_with_start, SEPARABLE_ONLY},
    {TVI_TYPE1, TVI_AT_BOTH_ENDS, TVI_NODES_TRUNCATED, TVI_TRAPEZOID, 2, stormer_verlet, SEPARABLE_ONLY},
    {TVI_TYPE1, TVI_AT_BOTH_ENDS, TVI_NODES_ON_CURVE, TVI_TRAPEZOID, 2, stormer_verlet, SEPARABLE_ONLY},
    {TVI_TYPE1, TVI_AT_BOTH_ENDS, TVI_NODES_TRUNCATED, TVI_GAUSS, 1, implicit_midpoint, ANY},
    {TVI_TYPE1, TVI_AT_BOTH_ENDS, TVI_NODES_ON_CURVE, TVI_GAUSS, 1, implicit_midpoint, ANY},
    {TVI_POINCARE, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, TVI_GAUSS, 1, implicit_midpoint, ANY},
    {TVI_TYPE2, TVI_AT_START, TVI_NODES_TRUNCATED, TVI_TRAPEZOID, 2, svhd_first, SEPARABLE_ONLY},
    {TVI_TYPE3, TVI_AT_END, TVI_NODES_TRUNCATED, TVI_TRAPEZOID, 2, svhd_second, SEPARABLE_ONLY},
};
enum { FORMS = sizeof forms / sizeof *forms };

static const model *const form_models[] = {&model_chain, &model_kepler, &model_nonseparable, &model_degenerate};
enum { FORM_MODELS = sizeof form_models / sizeof *form_models, FORM_STEPS = 30 };

static tvi_options form_options(int form)
{
    return (tvi_options){.method = forms[form].method,
                         .expansion = forms[form].expansion,
                         .nodes = forms[form].nodes,
                         .degree = forms[form].method == TVI_POINCARE ? 0 : 1,
                         .order = 2,
                         .quadrature = forms[form].quadrature,
                         .quadrature_points = forms[form].points};
}

static double form_error(const model *m, const test_state *x, const exact_state *exact)
{
    const test_state zero = {0};
    const two_errors error = state_error(m->n, x, exact), size = state_difference(m->n, x, &zero);
    return fmax(error.q / fmax(1, size.q), error.p / fmax(1, size.p));
}

/* One step and FORM_STEPS. */
static void check_form(const model *m, const tvi_options *options, closed_form *step)
{
    const double h = 0.0625;
    tvi_system *system = model_system(m);
    tvi_integrator *integrator = integrator_of(system, options);
    test_state x = model_start(m);
    exact_state exact = {.t = x.t};
    for (int i = 0; i < m->n; i++) exact.q[i] = x.q[i], exact.p[i] = x.p[i];
    for (int count = 1; count <= FORM_STEPS; count++) {
        go(integrator, h, 1, &x);
        step(m, h, &exact);
        const double error = form_error(m, &x, &exact);
        ck_assert_msg(error < (count == 1 ? 1e-15 : 1e-14), "%s, %s, step %d: %.1e", m->name, describe(options), count,
                      error);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}

START_TEST(method_is_its_closed_form)
{
    const int form = _i % FORMS;
    const model *m = form_models[_i / FORMS];
    const kind k = {.method = forms[form].method};
    if (!kind_serves(&k, m) || (!m->problem && forms[form].systems == SEPARABLE_ONLY)) return;
    const tvi_options options = form_options(form);
    check_form(m, &options, forms[form].step);
}
END_TEST

START_TEST(svhd_is_its_closed_form)
{
    tvi_options options;
    ck_assert_int_eq(tvi_options_named("svhd", 2, &options), TVI_OK);
    check_form(form_models[_i], &options, svhd);
}
END_TEST

/* ---- Section 8.6: which methods are one -------------------------------------------------------------------------- */

static double between(const model *m, int form, int other)
{
    test_state end[2];
    tvi_system *system = model_system(m);
    for (int i = 0; i < 2; i++) {
        const tvi_options options = form_options(i == 0 ? form : other);
        tvi_integrator *integrator = integrator_of(system, &options);
        end[i] = model_start(m);
        go(integrator, 0.0625, 1, &end[i]);
        tvi_integrator_free(integrator);
    }
    tvi_system_free(system);
    return distance(m->n, &end[0], &end[1]);
}

static int form_of(tvi_method method, tvi_expansion expansion, tvi_quadrature quadrature)
{
    int found = -1;
    for (int i = 0; i < FORMS && found < 0; i++)
        if (forms[i].method == method && forms[i].expansion == expansion && forms[i].quadrature == quadrature &&
            forms[i].nodes == TVI_NODES_TRUNCATED)
            found = i;
    ck_assert_int_ge(found, 0);
    return found;
}

/* The rectangle at the start makes one method of types I and II, that at the end one of types I and III; but type II
 * with the rectangle at the end, and type III with that at the start, are other methods, and no symplectic Euler. */
START_TEST(types_agree_where_they_do)
{
    const model *m = form_models[_i];
    const int one_a = form_of(TVI_TYPE1, TVI_AT_START, TVI_RECTANGLE_START);
    const int one_b = form_of(TVI_TYPE1, TVI_AT_END, TVI_RECTANGLE_END);
    ck_assert_double_lt(between(m, one_a, form_of(TVI_TYPE2, TVI_AT_START, TVI_RECTANGLE_START)), 1e-15);
    ck_assert_double_lt(between(m, one_b, form_of(TVI_TYPE3, TVI_AT_END, TVI_RECTANGLE_END)), 1e-15);
    ck_assert_double_gt(between(m, one_b, form_of(TVI_TYPE2, TVI_AT_START, TVI_RECTANGLE_END)), 1e-4);
    ck_assert_double_gt(between(m, one_a, form_of(TVI_TYPE3, TVI_AT_START, TVI_RECTANGLE_START)), 1e-4);
}
END_TEST

Suite *suite_forms(void)
{
    Suite *suite = suite_create("forms");
    TCase *tcase = tcase_create("forms");
    tcase_add_loop_test(tcase, method_is_its_closed_form, 0, FORMS * FORM_MODELS);
    tcase_add_loop_test(tcase, svhd_is_its_closed_form, 0, 2);
    tcase_add_loop_test(tcase, types_agree_where_they_do, 0, 2);
    suite_add_tcase(suite, tcase);
    return suite;
}
