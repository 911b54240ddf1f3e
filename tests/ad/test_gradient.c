/* test_gradient.c - Tests recorded gradients: against analytic derivatives, against tangents, and used a second time.
 */
#include "record.h"
#include "suites.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Analytic derivatives ---------------------------------------------------------------------------------------- */

enum { D_A, D_B, D_AA, D_AB, D_BB, DERIVATIVES };

typedef void derivatives_fn(double c, double a, double b, double d[DERIVATIVES]);

#define TWICE(name, first, second)                                                                                     \
    static void d_##name(double c, double a, double b, double d[DERIVATIVES])                                          \
    {                                                                                                                  \
        (void)c, (void)a, (void)b;                                                                                     \
        d[D_A] = first;                                                                                                \
        d[D_AA] = second;                                                                                              \
    }

TWICE(neg, -1, 0)
TWICE(sqr, 2 * a, 2)
TWICE(sqrt, 0.5 / sqrt(a), -0.25 / (a * sqrt(a)))
TWICE(pow, c *pow(a, c - 1), c *(c - 1) * pow(a, c - 2))
TWICE(exp, exp(a), exp(a))
TWICE(log, 1 / a, -1 / (a * a))
TWICE(sin, cos(a), -sin(a))
TWICE(cos, -sin(a), -cos(a))
TWICE(tan, 1 / (cos(a) * cos(a)), 2 * sin(a) / (cos(a) * cos(a) * cos(a)))
TWICE(asin, 1 / sqrt(1 - a * a), a / ((1 - a * a) * sqrt(1 - a * a)))
TWICE(acos, -1 / sqrt(1 - a * a), -a / ((1 - a * a) * sqrt(1 - a * a)))
TWICE(atan, 1 / (1 + a * a), -2 * a / ((1 + a * a) * (1 + a * a)))
TWICE(sinh, cosh(a), sinh(a))
TWICE(cosh, sinh(a), cosh(a))
TWICE(tanh, 1 / (cosh(a) * cosh(a)), -2 * tanh(a) / (cosh(a) * cosh(a)))
TWICE(asinh, 1 / sqrt(1 + a * a), -a / ((1 + a * a) * sqrt(1 + a * a)))
TWICE(acosh, 1 / sqrt(a * a - 1), -a / ((a * a - 1) * sqrt(a * a - 1)))
TWICE(atanh, 1 / (1 - a * a), 2 * a / ((1 - a * a) * (1 - a * a)))
TWICE(erf, 2 / sqrt(acos(-1)) * exp(-a * a), -4 * a / sqrt(acos(-1)) * exp(-a * a))

#define OF_TWO(name, da, db, daa, dab, dbb)                                                                            \
    static void d_##name(double c, double a, double b, double d[DERIVATIVES])                                          \
    {                                                                                                                  \
        (void)c, (void)a, (void)b;                                                                                     \
        d[D_A] = da;                                                                                                   \
        d[D_B] = db;                                                                                                   \
        d[D_AA] = daa;                                                                                                 \
        d[D_AB] = dab;                                                                                                 \
        d[D_BB] = dbb;                                                                                                 \
    }

OF_TWO(add, 1, 1, 0, 0, 0)
OF_TWO(sub, 1, -1, 0, 0, 0)
OF_TWO(mul, b, a, 0, 1, 0)
OF_TWO(div, 1 / b, -a / (b * b), 0, -1 / (b * b), 2 * a / (b * b * b))
OF_TWO(linear, 3, -0.25, 0, 0, 0)

static double r2(double a, double b) { return a * a + b * b; }
static double r3(double a, double b) { return r2(a, b) * sqrt(r2(a, b)); }

OF_TWO(atan2, b / r2(a, b), -a / r2(a, b), -2 * a * b / (r2(a, b) * r2(a, b)),
       (a - b) * (a + b) / (r2(a, b) * r2(a, b)), 2 * a * b / (r2(a, b) * r2(a, b)))
OF_TWO(hypot, a / sqrt(r2(a, b)), b / sqrt(r2(a, b)), b *b / r3(a, b), -a *b / r3(a, b), a *a / r3(a, b))

static const struct {
    const char *name;
    derivatives_fn *derivatives;
    double c, a, b;
} analytic[] = {
    {"add", d_add, 0, 0.7, -1.3},   {"sub", d_sub, 0, 0.7, -1.3},       {"mul", d_mul, 0, 0.7, -1.3},
    {"div", d_div, 0, 0.7, -1.3},   {"linear", d_linear, 0, 0.7, -1.3}, {"neg", d_neg, 0, 0.7, 0},
    {"sqr", d_sqr, 0, -0.7, 0},     {"sqrt", d_sqrt, 0, 0.7, 0},        {"pow", d_pow, 0, -0.7, 0},
    {"pow", d_pow, 1, -0.7, 0},     {"pow", d_pow, 2, -0.7, 0},         {"pow", d_pow, 5, -0.7, 0},
    {"pow", d_pow, -1, -0.7, 0},    {"pow", d_pow, -2, -0.7, 0},        {"pow", d_pow, 0.5, 0.7, 0},
    {"pow", d_pow, 1.5, 0.7, 0},    {"pow", d_pow, -2.5, 0.7, 0},       {"pow", d_pow, 0.3, 0.7, 0},
    {"exp", d_exp, 0, -0.7, 0},     {"log", d_log, 0, 0.7, 0},          {"sin", d_sin, 0, 0.7, 0},
    {"cos", d_cos, 0, 0.7, 0},      {"tan", d_tan, 0, -0.7, 0},         {"asin", d_asin, 0, 0.7, 0},
    {"acos", d_acos, 0, 0.7, 0},    {"atan", d_atan, 0, 0.7, 0},        {"sinh", d_sinh, 0, 0.7, 0},
    {"cosh", d_cosh, 0, 0.7, 0},    {"tanh", d_tanh, 0, 0.7, 0},        {"tanh", d_tanh, 0, 15, 0},
    {"tanh", d_tanh, 0, -300, 0},   {"asin", d_asin, 0, 0, 0},          {"sinh", d_sinh, 0, 0, 0},
    {"asinh", d_asinh, 0, -0.7, 0}, {"acosh", d_acosh, 0, 1.7, 0},      {"atanh", d_atanh, 0, 0.7, 0},
    {"erf", d_erf, 0, -0.7, 0},     {"atan2", d_atan2, 0, 0.7, -1.3},   {"hypot", d_hypot, 0, 0.7, -0.9},
};

/* A row of a matrix of derivatives by the recorded gradient. */
static void check_row(const char *name, recording r, const double at[], double da, double db)
{
    double got[2];
    ck_assert(run_values(&r, 1, at, got));
    ck_assert_msg(fabs(got[0] - da) <= 2e-15 * fabs(da), "%s: d/da is %.17g instead of %.17g", name, got[0], da);
    ck_assert_msg(fabs(got[1] - db) <= 2e-15 * fabs(db), "%s: d/db is %.17g instead of %.17g", name, got[1], db);
    recording_free(&r);
}

START_TEST(analytic_derivatives_are_met)
{
    const char *name = analytic[_i].name;
    const function f = {name, operation_named(name), 2, 1, analytic[_i].c, {analytic[_i].a, analytic[_i].b}, 0};
    double d[DERIVATIVES] = {0};
    analytic[_i].derivatives(f.c, f.centre[0], f.centre[1], d);
    check_row(name, record_gradient(&f, 0, JET_TAPE_VALUES), f.centre, d[D_A], d[D_B]);
    check_row(name, record_second_gradient(&f, 0, 0, JET_TAPE_VALUES), f.centre, d[D_AA], d[D_AB]);
    check_row(name, record_second_gradient(&f, 0, 1, JET_TAPE_VALUES), f.centre, d[D_AB], d[D_BB]);
}
END_TEST

/* ---- Tangents ---------------------------------------------------------------------------------------------------- */

enum { DEGREE = 20, SHORT = DEGREE + 1, SHIFT = 3, DIRECTIONS = 2 * INPUTS_MAX };

static double series[INPUTS_MAX * SHORT], gradient[INPUTS_MAX * SHORT];

/* The tangents of all outputs of r along e_i (lane i) and e_i s^SHIFT (lane inputs + i). */
static void run_unit_tangents(const recording *r, double *dz)
{
    const int lanes = 2 * r->inputs;
    double *dx = numbers((size_t)(r->inputs * SHORT * lanes));
    for (int i = 0; i < r->inputs; i++) {
        dx[(i * SHORT + 0) * lanes + i] = 1;
        dx[(i * SHORT + SHIFT) * lanes + r->inputs + i] = 1;
    }
    run_tangents(r, DEGREE, 1, lanes, series, dx, dz);
    free(dx);
}

/* The tangent of z along e_i s^j is the series g_i(x(s)) of the gradient, shifted by j. */
static void check_shifted(const function *f, const double *dz, int lanes, int lane, int shift, const double *g)
{
    double tangent[SHORT];
    for (int k = 0; k < shift; k++) ck_assert_double_eq(dz[k * lanes + lane], 0);
    for (int k = 0; k <= DEGREE - shift; k++) tangent[k] = dz[(k + shift) * lanes + lane];
    check_series(f->name, DEGREE - shift, g, tangent, 10 * f->bound);
}

static void check_gradient(const function *f, const recording *r, const double *dz)
{
    const int lanes = 2 * f->inputs;
    ck_assert(run_series(r, DEGREE, 1, series, gradient));
    for (int i = 0; i < f->inputs; i++) {
        check_shifted(f, dz, lanes, i, 0, gradient + i * SHORT);
        check_shifted(f, dz, lanes, f->inputs + i, SHIFT, gradient + i * SHORT);
    }
}

START_TEST(gradient_agrees_with_tangents)
{
    const function *f = any_function(_i);
    recording r = record_outputs(f, JET_TAPE_SERIES);
    double *dz = numbers((size_t)f->outputs * SHORT * DIRECTIONS);
    dense_series(f, DEGREE, series);
    run_unit_tangents(&r, dz);
    for (int output = 0; output < f->outputs; output++) {
        recording g = record_gradient(f, output, JET_TAPE_SERIES);
        check_gradient(f, &g, dz + (size_t)output * SHORT * 2 * (size_t)f->inputs);
        recording_free(&g);
    }
    free(dz);
    recording_free(&r);
}
END_TEST

START_TEST(second_gradient_agrees_with_tangents)
{
    const function *f = any_function(_i);
    recording r = record_gradient(f, f->outputs - 1, JET_TAPE_SERIES);
    double *dz = numbers((size_t)f->inputs * SHORT * DIRECTIONS);
    dense_series(f, DEGREE, series);
    run_unit_tangents(&r, dz);
    for (int i = 0; i < f->inputs; i++) {
        recording g = record_second_gradient(f, f->outputs - 1, i, JET_TAPE_SERIES);
        check_gradient(f, &g, dz + (size_t)i * SHORT * 2 * (size_t)f->inputs);
        recording_free(&g);
    }
    free(dz);
    recording_free(&r);
}
END_TEST

/* ---- The lift ---------------------------------------------------------------------------------------------------- */

/* Values are the function's own, and rates its tangents, along any series. */
static void check_lift(const function *f, bool of_gradient)
{
    static double direction[INPUTS_MAX * SHORT], in[2 * INPUTS_MAX * SHORT];
    recording lift = record_lift(f, of_gradient, JET_TAPE_SERIES);
    recording r =
        of_gradient ? record_gradient(f, f->outputs - 1, JET_TAPE_SERIES) : record_outputs(f, JET_TAPE_SERIES);
    const size_t size = (size_t)r.outputs * SHORT;
    double *out = numbers(2 * size), *z = numbers(size), *dz = numbers(size);
    dense_series(f, DEGREE, series);
    dense_direction(f, 1, DEGREE, direction);
    for (int i = 0; i < f->inputs; i++) {
        memcpy(in + (f->inputs - 1 - i) * SHORT, series + i * SHORT, SHORT * sizeof *in);
        memcpy(in + (2 * f->inputs - 1 - i) * SHORT, direction + i * SHORT, SHORT * sizeof *in);
    }
    ck_assert(run_series(&lift, DEGREE, 1, in, out));
    ck_assert(run_series(&r, DEGREE, 1, series, z));
    run_tangents(&r, DEGREE, 1, 1, series, direction, dz);
    for (int i = 0; i < r.outputs; i++) {
        check_series(f->name, DEGREE, out + i * SHORT, z + i * SHORT, 10 * f->bound);
        check_series(f->name, DEGREE, out + (r.outputs + i) * SHORT, dz + i * SHORT, 10 * f->bound);
    }
    free(out);
    free(z);
    free(dz);
    recording_free(&lift);
    recording_free(&r);
}

START_TEST(lift_agrees_with_tangents)
{
    check_lift(any_function(_i), false);
    check_lift(any_function(_i), true);
}
END_TEST

/* Everything that an output depends on must be there. */
START_TEST(lift_of_poison_is_poison)
{
    jet_graph *from = jet_graph_create(2), *graph = jet_graph_create(2);
    jet z = jet_mul(jet_graph_input(from, 0), jet_exp(jet_graph_input(from, 1))), value, rate;
    ck_assert_int_eq(jet_graph_check_outputs(from, 1, &z), TVI_OK);
    jet_graph_end_recording(from);
    const jet all[] = {jet_graph_input(graph, 0), jet_graph_input(graph, 1)}, one[] = {all[0], jet_make_unset_poison()};
    ck_assert(jet_record_forward_derivatives(from, graph, all, one, NULL, 1, &z, &value, &rate));
    ck_assert_int_eq(jet_graph_check_outputs(graph, 1, &value), TVI_OK);
    ck_assert_int_eq(jet_graph_check_outputs(graph, 1, &rate), TVI_EINVAL);
    ck_assert(jet_record_forward_derivatives(from, graph, one, all, NULL, 1, &z, &value, &rate));
    ck_assert_int_eq(jet_graph_check_outputs(graph, 1, &value), TVI_EINVAL);
    ck_assert_int_eq(jet_graph_check_outputs(graph, 1, &rate), TVI_EINVAL);
    jet_graph_free(from);
    jet_graph_free(graph);
}
END_TEST

/* ---- What is recorded -------------------------------------------------------------------------------------------- */

/* row(name, output of x and y, d/dx, d/dy, nodes added by the gradient): the derivatives are these very nodes. A row
 * that depends on the order of its arguments records one of them in `first`, since C does not fix that order. */
#define RECORDED(ROW)                                                                                                  \
    ROW(number, jet_const(3), jet_const(0), jet_const(0), 0)                                                           \
    ROW(input, y, jet_const(0), jet_const(1), 0)                                                                       \
    ROW(linear, jet_sub(jet_mul(2, x), jet_add(y, 5)), jet_const(2), jet_const(-1), 0)                                 \
    ROW(cancelled, jet_sub(jet_sin(x), jet_sin(x)), jet_const(0), jet_const(0), 0)                                     \
    ROW(product, jet_mul(x, y), y, x, 0)                                                                               \
    ROW(square, jet_sqr(x), jet_mul(2, x), jet_const(0), 1)                                                            \
    ROW(exponential, jet_exp(y), jet_const(0), jet_exp(y), 0)                                                          \
    ROW(sine, jet_sin(x), jet_cos(x), jet_const(0), 0)                                                                 \
    ROW(cosine, jet_cos(x), jet_neg(jet_sin(x)), jet_const(0), 1)                                                      \
    ROW(logarithm, jet_log(x), jet_div(1, x), jet_const(0), 2)                                                         \
    ROW(chain, jet_sin(jet_exp(x)), jet_mul(jet_exp(x), jet_cos(jet_exp(x))), jet_const(0), 1)                         \
    ROW(fan, jet_mul(x, jet_sin(x)), jet_add(jet_sin(x), jet_mul(x, jet_cos(x))), jet_const(0), 2)                     \
    ROW(cubic, (first = jet_sub(0.5, y), jet_mul(jet_sqr(y), first)), jet_const(0),                                    \
        jet_sub(jet_sub(y, jet_mul(2, jet_sqr(y))), jet_sqr(y)), 3)                                                    \
    ROW(mixed, jet_add(jet_mul(0.5, jet_sqr(y)), jet_mul(y, jet_sub(x, jet_div(jet_sqr(y), 3)))), y,                   \
        jet_add(jet_sub(x, jet_div(jet_sqr(y), 3)), jet_sub(y, jet_mul(2 / 3.0, jet_sqr(y)))), 4)                      \
    ROW(numbers,                                                                                                       \
        (first = jet_mul(y, 3), first = jet_mul(first, jet_add(jet_sin(x), y)),                                        \
         jet_add(jet_mul(y, jet_add(jet_sin(x), 1)), first)),                                                          \
        jet_mul(4, jet_mul(y, jet_cos(x))),                                                                            \
        jet_sum(((jet[]){jet_add(jet_sin(x), 1), jet_mul(3, y), jet_mul(3, jet_add(jet_sin(x), y))}), 3), 5)           \
    ROW(differences, (first = jet_sqr(jet_sub(x, 2)), jet_add(jet_sqr(jet_sub(x, y)), first)),                         \
        jet_add(jet_mul(2, jet_sub(x, y)), jet_mul(2, jet_sub(x, 2))), jet_mul(-2, jet_sub(x, y)), 4)

#define BUILD(name, output, by_x, by_y, nodes)                                                                         \
    static void build_##name(jet x, jet y, jet out[3])                                                                 \
    {                                                                                                                  \
        jet first = jet_const(0);                                                                                      \
        (void)x, (void)y, (void)first;                                                                                 \
        if (out[0].node == jet_make_unset_poison().node) out[0] = output;                                              \
        else out[1] = by_x, out[2] = by_y;                                                                             \
    }
RECORDED(BUILD)

#define ROW(name, output, by_x, by_y, nodes) {#name, build_##name, nodes},
static const struct {
    const char *name;
    void (*build)(jet x, jet y, jet out[3]);
    int nodes;
} recorded[] = {RECORDED(ROW)};

static void check_same(const char *name, jet got, jet want)
{
    ck_assert_msg(got.node == want.node, "%s: another node", name);
    if (!want.node) ck_assert_double_eq(got.number, want.number);
}

START_TEST(gradient_records_no_more_than_needed)
{
    jet_graph *graph = jet_graph_create(2);
    const jet a = jet_graph_input(graph, 0), b = jet_graph_input(graph, 1);
    jet out[3] = {jet_make_unset_poison(), jet_make_unset_poison(), jet_make_unset_poison()}, g[2];
    recorded[_i].build(a, b, out);
    const int before = jet_graph_node_count(graph);
    ck_assert(jet_record_gradient(graph, out[0], 2, g));
    ck_assert_int_eq(jet_graph_node_count(graph) - before, recorded[_i].nodes);
    recorded[_i].build(a, b, out);
    check_same(recorded[_i].name, g[0], out[1]);
    check_same(recorded[_i].name, g[1], out[2]);
    jet_graph_free(graph);
}
END_TEST

/* The status of the gradient of an output as outputs of the graph. */
static tvi_status gradient_status(jet_graph *graph, jet output)
{
    jet g[8];
    ck_assert(jet_record_gradient(graph, output, 8, g));
    return jet_graph_check_outputs(graph, 8, g);
}

/* A jet of no graph has no gradient in it, and that shows at the outputs. */
START_TEST(gradient_of_poison_is_poison)
{
    jet_graph *graph = jet_graph_create(8), *other = jet_graph_create(8);
    ck_assert_int_eq(gradient_status(graph, jet_make_unset_poison()), TVI_EINVAL);
    ck_assert_int_eq(gradient_status(graph, jet_log(0)), TVI_EDOMAIN);
    ck_assert_int_eq(gradient_status(graph, jet_exp(1000)), TVI_ENONFINITE);
    ck_assert_int_eq(gradient_status(graph, jet_sqr(jet_graph_input(other, 1))), TVI_EINVAL);
    ck_assert_int_eq(gradient_status(graph, jet_sqr(jet_graph_input(graph, 1))), TVI_OK);
    jet_graph_free(graph);
    jet_graph_free(other);
}
END_TEST

/* With respect to the first inputs alone: the others stay what they are. */
START_TEST(gradient_takes_the_first_inputs)
{
    jet_graph *graph = jet_graph_create(3);
    const jet a = jet_graph_input(graph, 0), b = jet_graph_input(graph, 1), t = jet_graph_input(graph, 2);
    jet g[3] = {jet_make_unset_poison(), jet_make_unset_poison(), jet_const(7)};
    ck_assert(jet_record_gradient(graph, jet_mul(jet_mul(a, t), b), 2, g));
    check_same("first", g[0], jet_mul(t, b));
    check_same("second", g[1], jet_mul(a, t));
    ck_assert_double_eq(g[2].number, 7);
    jet_graph_free(graph);
}
END_TEST

/* The gradient of a long inner product is the other factor, in the time of its length. */
START_TEST(gradient_of_long_dot)
{
    enum { LONG = 20000 };
    jet_graph *graph = jet_graph_create(2 * LONG);
    jet *in = malloc(2 * LONG * sizeof *in), *g = malloc(2 * LONG * sizeof *g);
    ck_assert(in && g);
    for (int i = 0; i < 2 * LONG; i++) in[i] = jet_graph_input(graph, i);
    ck_assert(jet_record_gradient(graph, jet_dot(in, in + LONG, LONG), 2 * LONG, g));
    for (int i = 0; i < LONG; i++) {
        check_same("first factor", g[i], in[LONG + i]);
        check_same("second factor", g[LONG + i], in[i]);
    }
    free(in);
    free(g);
    jet_graph_free(graph);
}
END_TEST

/* Many uses of one quantity: the sum of sin(i x), i = 1..LONG, has the derivative sum i cos(i x). */
START_TEST(gradient_of_many_uses)
{
    enum { LONG = 2000 };
    jet_graph *graph = jet_graph_create(1);
    jet waves[LONG], g;
    for (int i = 0; i < LONG; i++) waves[i] = jet_sin(jet_mul(i + 1, jet_graph_input(graph, 0)));
    ck_assert(jet_record_gradient(graph, jet_sum(waves, LONG), 1, &g));
    recording r = record_close(graph, 1, &g, JET_TAPE_VALUES);
    double slope, want = 0;
    const double at = 0.01;
    for (int i = LONG; i >= 1; i--) want += i * cos(i * at);
    ck_assert(run_values(&r, 1, &at, &slope));
    ck_assert_double_eq_tol(slope, want, 1e-13 * LONG * LONG);
    recording_free(&r);
}
END_TEST

#define COUNT(table) ((int)(sizeof table / sizeof table[0]))

Suite *gradient_suite(void)
{
    Suite *suite = suite_create("gradient");
    const int functions = operation_count + composition_count;
    tcase_add_loop_test(add_case(suite, "analytic"), analytic_derivatives_are_met, 0, COUNT(analytic));
    TCase *tangents = add_case(suite, "tangents");
    tcase_add_loop_test(tangents, gradient_agrees_with_tangents, 0, functions);
    tcase_add_loop_test(tangents, second_gradient_agrees_with_tangents, 0, functions);
    TCase *lift = add_case(suite, "lift");
    tcase_add_loop_test(lift, lift_agrees_with_tangents, 0, functions);
    tcase_add_test(lift, lift_of_poison_is_poison);
    TCase *graph = add_case(suite, "graph");
    tcase_add_loop_test(graph, gradient_records_no_more_than_needed, 0, COUNT(recorded));
    tcase_add_test(graph, gradient_of_poison_is_poison);
    tcase_add_test(graph, gradient_takes_the_first_inputs);
    tcase_add_test(graph, gradient_of_long_dot);
    tcase_add_test(graph, gradient_of_many_uses);
    return suite;
}
