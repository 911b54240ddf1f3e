/* test_geometry.c - Tests what every generating function keeps: the symplectic form, the momenta of symmetries, the
 * energy without trend (docs/method.md sections 3 to 6). Every property has a control that must fail it. */
#include "generating.h"
#include "models.h"

#include <math.h>

/* ---- Symplecticity: M^T J M = J for the derivative M of a step; test_tangent_map.c holds M against differences --- */

/* At a place away from any symmetry. */
static double defect_of(const model *m, const tvi_options *options)
{
    tvi_system *system = model_system(m);
    tvi_integrator *integrator = integrator_of(system, options);
    double M[4 * N_MAX * N_MAX];
    test_state x = model_place(m);
    go_tangent(m->n, integrator, m->h, &x, M);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return symplectic_defect(m->n, M);
}

/* Roundoff, and what is no roundoff. */
static const double SYMPLECTIC = 4e-15, NOT_SYMPLECTIC = 1e-12;

static const struct {
    tvi_quadrature quadrature;
    int points;
} rules[] = {
    {TVI_QUADRATURE_AUTO, 0}, {TVI_GAUSS, 1},   {TVI_GAUSS, 2},     {TVI_GAUSS, 3},           {TVI_LOBATTO, 2},
    {TVI_LOBATTO, 3},         {TVI_LOBATTO, 4}, {TVI_TRAPEZOID, 0}, {TVI_RECTANGLE_START, 0}, {TVI_RECTANGLE_END, 0},
};
enum { RULES = sizeof rules / sizeof *rules, DEGREES = 6 };

/* Every S(z) makes a symplectic map, whatever its quadrature. */
START_TEST(method_is_symplectic)
{
    const kind *k = &kinds[_i % all_kinds];
    const model *m = models[_i / all_kinds];
    if (!kind_serves(k, m)) return;
    for (int degree = kind_least_degree(k); degree <= DEGREES; degree++)
        for (int rule = 0; rule < (k->expansion == TVI_AT_NODES || degree == 0 ? 1 : RULES); rule++)
            for (int composed = 0; composed < (rule == 0 || rule == RULES - 1 ? 2 : 1); composed++) {
                tvi_options options = kind_options_with(k, degree, rules[rule].quadrature, rules[rule].points);
                options.compose_adjoint = composed;
                const double defect = defect_of(m, &options);
                ck_assert_msg(defect < SYMPLECTIC, "%s, %s: defect %.1e", m->name, describe(&options), defect);
            }
}
END_TEST

START_TEST(verlet_is_symplectic)
{
    const tvi_options options = options_verlet();
    if (!models[_i]->problem) return;
    ck_assert_double_lt(defect_of(models[_i], &options), SYMPLECTIC);
}
END_TEST

/* Taylor's method, and passes that have not converged (section 5), are not. */
START_TEST(others_are_not_symplectic)
{
    const kind *k = &kinds[_i % all_kinds];
    const model *m = models[_i / all_kinds];
    if (!kind_serves(k, m)) return;
    const tvi_options taylor = options_taylor(4);
    tvi_options without = kind_options(k, 3), one = kind_options(k, 2), loose = one;
    without.passes = TVI_PREDICT_ONLY;
    one.passes = 1;
    loose.tolerance = 0.1;
    const struct {
        const tvi_options *options;
        double least;
    } rows[] = {{&taylor, 1e-9}, {&without, 1e-9}, {&one, NOT_SYMPLECTIC}, {&loose, NOT_SYMPLECTIC}};
    const int count = m == &model_degenerate ? 2 : 4; /* its H is linear in p: there a pass may solve the equations */
    for (int row = 0; row < count; row++) {
        const double defect = defect_of(m, rows[row].options);
        ck_assert_msg(defect > rows[row].least, "%s, %s, row %d: defect %.1e", m->name, describe(rows[row].options),
                      row, defect);
    }
}
END_TEST

/* ---- Momenta ----------------------------------------------------------------------------------------------------- */

enum { MOMENTA = 3 };
typedef void momentum_function(const test_state *x, double out[MOMENTA]);

/* x p_y - y p_x. */
static void turning(const test_state *x, double out[MOMENTA])
{
    out[0] = x->q[0] * x->p[1] - x->q[1] * x->p[0];
    out[1] = out[2] = 0;
}

/* sum G x, sum G y of the vortices, with q = sqrt(G) x, p = sqrt(G) y. */
static void vorticity_centre(const test_state *x, double out[MOMENTA])
{
    static const double root[] = {1, 2, 1, 0.5};
    out[0] = out[1] = out[2] = 0;
    for (int i = 0; i < 4; i++) {
        out[0] += root[i] * x->q[i];
        out[1] += root[i] * x->p[i];
    }
}

/* sum G (x^2 + y^2): its flow turns q into p, which no action on the coordinates does. */
static void angular_impulse(const test_state *x, double out[MOMENTA])
{
    out[0] = out[1] = out[2] = 0;
    for (int i = 0; i < 4; i++) out[0] += x->q[i] * x->q[i] + x->p[i] * x->p[i];
}

/* The largest change over many steps. */
static double momentum_change(const model *m, const tvi_options *options, int steps, momentum_function *momentum)
{
    tvi_system *system = model_system(m);
    tvi_integrator *integrator = integrator_of(system, options);
    test_state x = model_start(m);
    double first[MOMENTA], now[MOMENTA], change = 0;
    momentum(&x, first);
    for (int step = 0; step < steps; step++) {
        go(integrator, m->h, 1, &x);
        momentum(&x, now);
        for (int i = 0; i < MOMENTA; i++) change = fmax(change, fabs(now[i] - first[i]));
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return change;
}

static const struct {
    const model *m;
    momentum_function *momentum;
    int steps; /* the charge is in ever stronger fields later */
} momenta[] = {
    {&model_kepler, turning, 2000}, {&model_magnetic, turning, 250}, {&model_vortices, vorticity_centre, 2000}};
enum { MOMENTUM_ROWS = sizeof momenta / sizeof *momenta, MANY_STEPS = 2000, FEW_STEPS = 50 };

START_TEST(momenta_are_kept)
{
    const kind *k = &kinds[_i % all_kinds];
    const int row = _i / all_kinds;
    const model *m = momenta[row].m;
    if (!kind_serves(k, m)) return;
    const tvi_options options = kind_options(k, 4);
    const double change = momentum_change(m, &options, momenta[row].steps, momenta[row].momentum);
    ck_assert_msg(change < 2e-13, "%s, %s: %.1e", m->name, describe(&options), change);
}
END_TEST

/* Poincare and Galerkin keep what a linear flow that mixes q and p keeps; types II and III do not. */
START_TEST(angular_impulse_is_kept_by_symmetric_methods)
{
    const kind *k = &kinds[_i];
    if (!kind_serves(k, &model_vortices)) return;
    const tvi_options options = kind_options(k, 2);
    const bool keeps = k->symmetric;
    const double change = momentum_change(&model_vortices, &options, keeps ? MANY_STEPS : FEW_STEPS, angular_impulse);
    ck_assert_msg(keeps ? change < 2e-13 : change > 1e-7, "%s: %.1e", describe(&options), change);
}
END_TEST

/* A centre of vorticity is linear, which every consistent method keeps: no control there. */
START_TEST(taylor_does_not_keep_momenta)
{
    const tvi_options options = options_taylor(5);
    ck_assert_double_gt(momentum_change(&model_kepler, &options, FEW_STEPS, turning), 1e-8);
    ck_assert_double_gt(momentum_change(&model_magnetic, &options, FEW_STEPS, turning), 1e-8);
    ck_assert_double_gt(momentum_change(&model_vortices, &options, FEW_STEPS, angular_impulse), 1e-8);
}
END_TEST

/* ---- Energy ------------------------------------------------------------------------------------------------------ */

typedef struct {
    double first, last; /* largest |H - H0| over the first and the last tenth of the run */
} energy_error;

static energy_error energy_over(const model *m, const tvi_options *options, double h, int steps)
{
    tvi_system *system = model_system(m);
    tvi_integrator *integrator = integrator_of(system, options);
    test_state x = model_start(m);
    const double H0 = state_energy(system, &x);
    energy_error error = {0, 0};
    for (int step = 0; step < steps; step++) {
        go(integrator, h, 1, &x);
        const bool early = step < steps / 10, late = step >= steps - steps / 10;
        if (!early && !late) continue;
        const double now = fabs(state_energy(system, &x) - H0);
        if (early) error.first = fmax(error.first, now);
        else error.last = fmax(error.last, now);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return error;
}

static const struct {
    const model *m;
    kind k;
    int degree;
    double h;
    int steps;
} energy_rows[] = {
    {&model_double_pendulum, {TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 2, 0.03125, 100000},
    {&model_nonseparable, {TVI_TYPE2, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 2, 0.125, 10000},
    {&model_nonseparable, {TVI_POINCARE, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 1, 0.125, 10000},
    {&model_kepler, {TVI_TYPE3, TVI_AT_END, TVI_NODES_TRUNCATED, false}, 4, 0.0625, 10000},
    {&model_kepler, {TVI_TYPE1, TVI_AT_BOTH_ENDS, TVI_NODES_ON_CURVE, true}, 2, 0.0625, 10000},
    {&model_nonseparable, {TVI_TYPE1, TVI_AT_NODES, TVI_NODES_ON_CURVE, true}, 2, 0.125, 10000},
};
enum { ENERGY_ROWS = sizeof energy_rows / sizeof *energy_rows };

START_TEST(energy_error_has_no_trend)
{
    const tvi_options options = kind_options(&energy_rows[_i].k, energy_rows[_i].degree);
    const energy_error error = energy_over(energy_rows[_i].m, &options, energy_rows[_i].h, energy_rows[_i].steps);
    ck_assert_msg(error.last < 1.3 * error.first && error.last > error.first / 1.3 && error.first > 1e-12,
                  "%s, %s: %.2e, then %.2e", energy_rows[_i].m->name, describe(&options), error.first, error.last);
}
END_TEST

static int order_of(const model *m, const tvi_options *options)
{
    tvi_system *system = model_system(m);
    tvi_integrator *integrator = integrator_of(system, options);
    const int order = tvi_integrator_options(integrator)->order;
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return order;
}

/* A method of the same order. */
START_TEST(energy_of_taylor_drifts)
{
    const tvi_options symplectic = kind_options(&energy_rows[_i].k, energy_rows[_i].degree);
    const tvi_options options = {.method = TVI_TAYLOR, .order = order_of(energy_rows[_i].m, &symplectic)};
    const energy_error error = energy_over(energy_rows[_i].m, &options, energy_rows[_i].h, energy_rows[_i].steps);
    ck_assert_msg(error.last > 3 * error.first, "%s: %.2e, then %.2e", energy_rows[_i].m->name, error.first,
                  error.last);
}
END_TEST

Suite *suite_geometry(void)
{
    Suite *suite = suite_create("geometry");
    TCase *tcase = tcase_create("geometry");
    tcase_add_loop_test(tcase, method_is_symplectic, 0, MODELS * all_kinds);
    tcase_add_loop_test(tcase, verlet_is_symplectic, 0, MODELS);
    tcase_add_loop_test(tcase, others_are_not_symplectic, 0, MODELS * all_kinds);
    tcase_add_loop_test(tcase, momenta_are_kept, 0, MOMENTUM_ROWS * all_kinds);
    tcase_add_loop_test(tcase, angular_impulse_is_kept_by_symmetric_methods, 0, all_kinds);
    tcase_add_test(tcase, taylor_does_not_keep_momenta);
    tcase_add_loop_test(tcase, energy_error_has_no_trend, 0, ENERGY_ROWS);
    tcase_add_loop_test(tcase, energy_of_taylor_drifts, 0, ENERGY_ROWS);
    suite_add_tcase(suite, tcase);
    return suite;
}
