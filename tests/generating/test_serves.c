/* test_serves.c - Tests which system serves which method (docs/method.md section 4), what is refused and why, and where
 * a Legendre transform is singular. */
#include "generating.h"
#include "models.h"
#include "statements.h"

#include <math.h>
#include <string.h>

/* ---- The table --------------------------------------------------------------------------------------------------- */

enum { SEPARABLE = 1, LAGRANGIAN = 2, REGULAR = 4, DEGENERATE = 8 };

/* Type I to the options, a method of its own in what it serves. */
enum { GALERKIN_CURVE = TVI_STORMER_VERLET + 1 };

static const struct {
    const model *m;
    int is;
} systems[] = {
    {&model_kepler, SEPARABLE},      {&model_chain, SEPARABLE},      {&model_double_pendulum, LAGRANGIAN},
    {&model_magnetic, LAGRANGIAN},   {&model_nonseparable, REGULAR}, {&model_sheared_hamiltonian, REGULAR},
    {&model_degenerate, DEGENERATE}, {&model_vortices, DEGENERATE},
};
enum { SYSTEMS = sizeof systems / sizeof *systems };

static const struct {
    int method;
    int serves;
    const char *word; /* of the reason of a refusal */
} table[] = {
    {GALERKIN_CURVE, SEPARABLE | LAGRANGIAN | REGULAR | DEGENERATE, ""},
    {TVI_TYPE1, SEPARABLE | LAGRANGIAN | REGULAR, "degenerate"},
    {TVI_TYPE2, SEPARABLE | REGULAR | DEGENERATE, "Hamiltonian"},
    {TVI_TYPE3, SEPARABLE | REGULAR | DEGENERATE, "Hamiltonian"},
    {TVI_POINCARE, SEPARABLE | REGULAR | DEGENERATE, "Hamiltonian"},
    {TVI_TAYLOR, SEPARABLE | LAGRANGIAN | REGULAR | DEGENERATE, ""},
    {TVI_STORMER_VERLET, SEPARABLE, "Stormer-Verlet"},
};
enum { METHODS = sizeof table / sizeof *table };

static int row_of(const tvi_options *options)
{
    const int method = options->expansion == TVI_AT_NODES ? GALERKIN_CURVE : (int)options->method;
    for (int row = 0; row < METHODS; row++)
        if (table[row].method == method) return row;
    ck_abort_msg("no such method");
    return 0;
}

static void check_service(int which, const tvi_options *options)
{
    const int row = row_of(options);
    const model *m = systems[which].m;
    tvi_system *system = model_system(m);
    tvi_integrator *integrator = (tvi_integrator *)&system;
    const char *why = NULL;
    const tvi_status checked = tvi_options_check(system, options, &why);
    const tvi_status created = tvi_integrator_create(&integrator, system, options);
    ck_assert_int_eq(checked, created);
    if (systems[which].is & table[row].serves) {
        ck_assert_msg(created == TVI_OK, "%s, %s: %s", m->name, describe(options), why);
        test_state x = model_start(m);
        go(integrator, m->h / 4, 1, &x);
    } else {
        ck_assert_msg(created == TVI_EUNSUPPORTED, "%s, %s: %s", m->name, describe(options),
                      tvi_status_string(created));
        ck_assert_ptr_null(integrator);
        ck_assert_ptr_nonnull(why);
        ck_assert_msg(strstr(why, table[row].word), "%s, %s: \"%s\"", m->name, describe(options), why);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}

START_TEST(systems_serve_methods)
{
    const tvi_options taylor = options_taylor(4), verlet = options_verlet();
    for (int k = 0; k < all_kinds; k++) {
        tvi_options options = kind_options(&kinds[k], 3);
        check_service(_i, &options);
        options.compose_adjoint = !kinds[k].symmetric;
        check_service(_i, &options);
    }
    check_service(_i, &taylor);
    check_service(_i, &verlet);
}
END_TEST

/* A system that does not choose gets a symmetric method that serves it. */
START_TEST(default_serves_every_system)
{
    tvi_system *system = model_system(systems[_i].m);
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, NULL), TVI_OK);
    const tvi_options *options = tvi_integrator_options(integrator), usual = tvi_options_default();
    ck_assert_int_eq(tvi_options_check(system, &usual, NULL), TVI_OK);
    ck_assert_int_eq(options->method, TVI_TYPE1);
    ck_assert_int_eq(options->expansion, TVI_AT_NODES);
    ck_assert_int_eq(options->order, 16);
    test_state x = model_start(systems[_i].m);
    go(integrator, systems[_i].m->h, 1, &x);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* ---- Names ------------------------------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    tvi_method method;
    tvi_expansion expansion;
    tvi_nodes nodes;
    int order,
        degree; /* degree 4 gives order; the next even order needs the next degree but the truncated, that below */
} names[] = {
    {"end", TVI_TYPE1, TVI_AT_END, TVI_NODES_ON_CURVE, 8, 4},
    {"symmetric-tvi", TVI_TYPE1, TVI_AT_BOTH_ENDS, TVI_NODES_TRUNCATED, 4, 3},
    {"both-ends", TVI_TYPE1, TVI_AT_BOTH_ENDS, TVI_NODES_ON_CURVE, 8, 4},
    {"htvi-right", TVI_TYPE2, TVI_AT_START, TVI_NODES_TRUNCATED, 4, 4},
    {"right", TVI_TYPE2, TVI_AT_START, TVI_NODES_ON_CURVE, 8, 4},
    {"htvi-left", TVI_TYPE3, TVI_AT_START, TVI_NODES_TRUNCATED, 4, 4},
    {"left", TVI_TYPE3, TVI_AT_START, TVI_NODES_ON_CURVE, 8, 4},
    {"poincare", TVI_POINCARE, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 8, 3},
    {"poincare", TVI_POINCARE, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 2, 0},
    {"galerkin", TVI_TYPE1, TVI_AT_NODES, TVI_NODES_ON_CURVE, 8, 4},
};
enum { NAMES = sizeof names / sizeof *names };

START_TEST(names_are_methods)
{
    tvi_options options;
    ck_assert_int_eq(tvi_options_named(names[_i].name, names[_i].order, &options), TVI_OK);
    ck_assert_int_eq(options.method, names[_i].method);
    ck_assert_int_eq(options.expansion, names[_i].expansion);
    ck_assert_int_eq(options.nodes, names[_i].nodes);
    tvi_system *system = model_system(&model_kepler);
    tvi_integrator *integrator = integrator_of(system, &options);
    ck_assert_int_eq(tvi_integrator_options(integrator)->degree, names[_i].degree);
    ck_assert_int_eq(tvi_integrator_options(integrator)->order, names[_i].order);
    const bool at_nodes = names[_i].expansion == TVI_AT_NODES;
    ck_assert_int_eq(tvi_integrator_options(integrator)->quadrature_points, names[_i].order / 2 + !at_nodes);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* ---- Singular Legendre transforms -------------------------------------------------------------------------------- */

static jet half_of_it(const jet q[], const jet v[], jet t, void *ctx) /* v_1 is missing */
{
    (void)t, (void)ctx;
    return jet_sub(jet_mul(0.5, jet_sqr(v[0])), jet_dot(q, q, 2));
}

static jet linear(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_sub(jet_mul(q[0], v[1]), jet_mul(q[1], v[0])), jet_dot(q, q, 2));
}

static jet of_the_sum(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_sqr(jet_add(jet_mul(q[0], v[0]), v[1])), jet_dot(q, q, 2));
}

static jet without_velocity(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)v, (void)t, (void)ctx;
    return jet_dot(q, q, 2);
}

START_TEST(singular_lagrangians_are_refused)
{
    static tvi_lagrangian_fn *const singular[] = {half_of_it, linear, of_the_sum, without_velocity};
    tvi_system *system = (tvi_system *)&system;
    ck_assert_int_eq(tvi_system_lagrangian(&system, 2, singular[_i], NULL), TVI_ESINGULAR);
    ck_assert_ptr_null(system);
    ck_assert_int_eq(tvi_system_hamiltonian(&system, 2, singular[_i], NULL), TVI_OK);
    tvi_system_free(system);
}
END_TEST

/* L_vv = q^2. */
static jet vanishing_mass(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_mul(0.5, jet_sqr(jet_mul(q[0], v[0]))), q[0]);
}

/* H_pp = 2 p. */
static jet cubic(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_div(jet_pow(p[0], 3), 3), jet_mul(0.5, jet_sqr(q[0])));
}

/* The state is as it was after the failure, and the integrator goes on from a better one. */
static void check_failure(const tvi_system *system, const tvi_options *options, test_state at, test_state better)
{
    tvi_integrator *integrator = integrator_of(system, options);
    test_state x = at;
    double q, p;
    const tvi_status status = tvi_step(integrator, 0.0625, &x.t, x.q, x.p);
    ck_assert_msg(status == TVI_ESINGULAR, "%s: %s", describe(options), tvi_status_string(status));
    ck_assert_mem_eq(&x, &at, sizeof x);
    ck_assert_int_eq(tvi_dense(integrator, 0.5, &q, &p), TVI_EINVAL);
    go(integrator, 0.0625, 1, &better);
    ck_assert_int_eq(tvi_dense(integrator, 0.5, &q, &p), TVI_OK);
    tvi_integrator_free(integrator);
}

START_TEST(singular_places_fail_at_the_step)
{
    const kind *k = &kinds[_i];
    const test_state origin = {0}, away = {.q = {1}, .p = {1}};
    tvi_system *L, *H;
    ck_assert_int_eq(tvi_system_lagrangian(&L, 1, vanishing_mass, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_hamiltonian(&H, 1, cubic, NULL), TVI_OK);
    const tvi_options options = kind_options(k, 3);
    if (k->method == TVI_TYPE1) {
        check_failure(L, &options, origin, away);
        check_failure(H, &options, origin, away);
    } else {
        tvi_integrator *integrator = integrator_of(H, &options);
        test_state x = origin;
        go(integrator, 0.0625, 1, &x);
        tvi_integrator_free(integrator);
    }
    double v = 3;
    ck_assert_int_eq(tvi_velocity(L, 0, origin.q, away.p, &v), TVI_ESINGULAR);
    ck_assert_double_eq(v, 3);
    tvi_system_free(L);
    tvi_system_free(H);
}
END_TEST

Suite *suite_serves(void)
{
    Suite *suite = suite_create("serves");
    TCase *tcase = tcase_create("serves");
    tcase_add_loop_test(tcase, systems_serve_methods, 0, SYSTEMS);
    tcase_add_loop_test(tcase, default_serves_every_system, 0, SYSTEMS);
    tcase_add_loop_test(tcase, names_are_methods, 0, NAMES);
    tcase_add_loop_test(tcase, singular_lagrangians_are_refused, 0, 4);
    tcase_add_loop_test(tcase, singular_places_fail_at_the_step, 0, kind_count);
    suite_add_tcase(suite, tcase);
    return suite;
}
