/* test_lowest.c - Tests the lowest degree of every method, with many coordinates and a force that has a pole: nothing
 * is read of a series that such a curve has not evaluated. */
#include "stability.h"
#include "method/list.h"
#include "method/method.h"

#include <math.h>
#include <string.h>

enum { COORDINATES = 40, STEPS = 10 };

/* V = sum_i 1/q_i + q_i^1.5: coordinates that know nothing of each other, each with a pole at 0. */
static jet poles(const jet q[], jet t, void *ctx)
{
    jet V = jet_const(0);
    (void)t;
    for (int i = 0; i < *(const int *)ctx; i++) V = jet_add(V, jet_add(jet_div(1, q[i]), jet_pow(q[i], 1.5)));
    return V;
}

/* Each method with each node rule, alone and composed. */
static int rows(void)
{
    int methods = 0;
    while (tvi_methods[methods]) methods++;
    return 4 * methods;
}

/* Row `i` of them, at its lowest order; false: there is no such method. */
static bool lowest_options(int i, tvi_options *options)
{
    *options = (tvi_options){.method = tvi_methods[i / 4]->method,
                             .expansion = tvi_methods[i / 4]->expansion,
                             .nodes = i % 2 ? TVI_NODES_TRUNCATED : TVI_NODES_ON_CURVE,
                             .compose_adjoint = i / 2 % 2};
    int one = 1;
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 1, NULL, poles, &one), TVI_OK);
    bool is_method = false;
    for (options->order = 1; !is_method && options->order <= 3; options->order += !is_method)
        is_method = tvi_options_check(system, options, NULL) == TVI_OK;
    tvi_system_free(system);
    return is_method;
}

static void run(int n, const tvi_options *options, double q[], double p[])
{
    double t = 0;
    tvi_system *system;
    tvi_integrator *integrator;
    for (int i = 0; i < n; i++) {
        q[i] = 1 + 0.25 * (i % 3);
        p[i] = 0.5 - 0.25 * (i % 5);
    }
    ck_assert_int_eq(tvi_system_potential(&system, n, NULL, poles, &n), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, options), TVI_OK);
    const tvi_status status = tvi_integrate(integrator, 0.05, STEPS, &t, q, p, NULL, NULL);
    ck_assert_msg(status == TVI_OK, "method %d at %d, nodes %d, n = %d: %s", (int)options->method,
                  (int)options->expansion, (int)options->nodes, n, tvi_status_string(status));
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}

/* Each coordinate moves as it does among fewer others, n = 1 ... 7, whose Jacobians are matrices. */
START_TEST(lowest_degree_of_all_methods)
{
    tvi_options options;
    double q[COORDINATES], p[COORDINATES], few_q[COORDINATES], few_p[COORDINATES];
    if (!lowest_options(_i, &options)) return;
    for (int n = COORDINATES; n >= 1; n -= n > 16 ? 8 : 1) {
        run(n, &options, q, p);
        for (int i = 0; i < n && n < COORDINATES; i++) {
            ck_assert_msg(fabs(q[i] - few_q[i]) <= 4e-15, "row %d, n = %d: q[%d] %g", _i, n, i, q[i] - few_q[i]);
            ck_assert_msg(fabs(p[i] - few_p[i]) <= 4e-15, "row %d, n = %d: p[%d] %g", _i, n, i, p[i] - few_p[i]);
        }
        memcpy(few_q, q, sizeof q);
        memcpy(few_p, p, sizeof p);
    }
    ck_assert_double_gt(fabs(q[0] - 1), 0.01); /* it moved */
}
END_TEST

/* The rows above are methods, the lowest of Stormer-Verlet and of the composed type II among them. */
START_TEST(there_are_such_methods)
{
    int methods = 0;
    for (int i = 0; i < rows(); i++) {
        tvi_options options;
        const bool is_method = lowest_options(i, &options),
                   is_listed = tvi_find_method(&options) && (!options.compose_adjoint || tvi_methods[i / 4]->adjoint);
        ck_assert_msg(is_method == is_listed, "row %d", i);
        methods += is_method;
    }
    ck_assert_int_ge(methods, 38);
}
END_TEST

Suite *suite_lowest(void)
{
    Suite *suite = suite_create("lowest");
    TCase *tcase = tcase_create("lowest");
    tcase_add_loop_test(tcase, lowest_degree_of_all_methods, 0, rows());
    tcase_add_test(tcase, there_are_such_methods);
    suite_add_tcase(suite, tcase);
    return suite;
}
