/* test_definition.c - Tests steps of the library against the same methods from their definition (definition.h). */
#include "generating.h"
#include "method/method.h"
#include "definition.h"

#include <math.h>

static const law separable = {0, 0}, general = {0.75, 0.5};
/* ---- The comparison ---------------------------------------------------------------------------------------------- */

#define ROOT_3  1.7320508075688772935274463L
#define ROOT_15 3.8729833462074168851792654L
static const rule rules[] = {
    {TVI_GAUSS, 2, {0.5L, 0.5L}, {(3 - ROOT_3) / 6, (3 + ROOT_3) / 6}},
    {TVI_GAUSS, 3, {5 / 18.0L, 8 / 18.0L, 5 / 18.0L}, {(5 - ROOT_15) / 10, 0.5L, (5 + ROOT_15) / 10}},
    {TVI_LOBATTO, 3, {1 / 6.0L, 4 / 6.0L, 1 / 6.0L}, {0, 0.5L, 1}},
    {TVI_TRAPEZOID, 2, {0.5L, 0.5L}, {0, 1}},
    {TVI_RECTANGLE_START, 1, {1}, {0}},
    {TVI_RECTANGLE_END, 1, {1}, {1}},
};
enum {
    RULES = sizeof rules / sizeof *rules,
    STATEMENTS = 3,
    SMALL_STEPS = 1
}; /* the first rule with a small step too */

/* The separable problem, and the general one as a Lagrangian and as a Hamiltonian. */
static tvi_system *stated(int statement)
{
    law l = statement == 0 ? separable : general;
    tvi_system *system;
    const tvi_status status = statement == 1 ? tvi_system_lagrangian(&system, n, law_record_lagrangian, &l)
                                             : tvi_system_hamiltonian(&system, n, law_record_hamiltonian, &l);
    ck_assert_int_eq(status, TVI_OK);
    return system;
}

static void check_step(const tvi_system *system, const method *m)
{
    const test_state start = {.t = 0.3, .q = {0.4, -0.3}, .p = {0.5, 0.2}};
    tvi_options options = kind_options_with(m->k, m->degree, m->nodes->quadrature, m->nodes->points);
    const char *why;
    if (tvi_options_check(system, &options, &why) == TVI_EINVAL && m->degree == 0)
        return; /* the rectangle is of order 1 */
    tvi_integrator *integrator = integrator_of(system, &options);
    test_state x = start;
    ends e;
    go(integrator, (double)m->h, 1, &x);
    if (m->k->expansion == TVI_AT_BOTH_ENDS) definition_step_both(m, &start, &e);
    else definition_step(m, &start, &e);
    real error = 0;
    for (int i = 0; i < n; i++) error = fmaxl(error, fmaxl(fabsl(x.q[i] - e.q1[i]), fabsl(x.p[i] - e.p1[i])));
    ck_assert_msg(error < 1e-15L, "%s, form of system %d: %.1e", describe(&options), options.method, (double)error);
    tvi_integrator_free(integrator);
}

START_TEST(step_is_that_of_the_definition)
{
    const kind *k = &kinds[_i % kind_count];
    const tvi_options options = kind_options(k, 1);
    const tvi_step_span span = tvi_find_method(&options)->curve.step_span;
    const int statement = _i / kind_count;
    if (statement == 1 && k->method != TVI_TYPE1) return;
    tvi_system *system = stated(statement);
    for (int degree = kind_least_degree(k); degree < TOP; degree++)
        for (int which = 0; which < RULES + SMALL_STEPS; which++) {
            const method m = {.l = statement == 0 ? &separable : &general,
                              .k = k,
                              .nodes = &rules[which % RULES],
                              .degree = degree,
                              .t = 0.3,
                              .h = which < RULES ? 0.0625 : 0.0117,
                              .centre = -span.start_s / ((real)span.end_s - span.start_s)};
            check_step(system, &m);
        }
    tvi_system_free(system);
}
END_TEST

Suite *suite_definition(void)
{
    Suite *suite = suite_create("definition");
    TCase *tcase = tcase_create("definition");
    tcase_add_loop_test(tcase, step_is_that_of_the_definition, 0, STATEMENTS * kind_count);
    suite_add_tcase(suite, tcase);
    return suite;
}
