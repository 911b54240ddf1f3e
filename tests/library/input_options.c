/* input_options.c - Tests options that make no method: each has its status and its reason, whoever asks. The contracts
 * are those of tvi.h. */
#include "input.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- Systems of every form --------------------------------------------------------------------------------------- */

/* VORTICES: H_pp is singular because of a symmetry, and no row of it is zero. */
typedef enum { SEPARABLE, GENERAL, REGULAR, DEGENERATE, VORTICES, FORMS } form;

static jet degenerate(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_dot(p, q, 2);
}

static tvi_system *create_form(form of)
{
    tvi_system *system;
    const tvi_status status = of == SEPARABLE    ? tvi_system_potential(&system, 2, NULL, harmonic, NULL)
                              : of == GENERAL    ? tvi_system_lagrangian(&system, 2, mixed_lagrangian, NULL)
                              : of == REGULAR    ? tvi_system_hamiltonian(&system, 2, mixed_hamiltonian, NULL)
                              : of == DEGENERATE ? tvi_system_hamiltonian(&system, 2, degenerate, NULL)
                                                 : scene_system(&scene_vortices, &system);
    ck_assert_int_eq(status, TVI_OK);
    return system;
}

/* ---- Options ----------------------------------------------------------------------------------------------------- */

typedef struct {
    const char *name;
    tvi_options options;
    tvi_status status;
    const char *culprit;
} options_case;

#define START    .method = TVI_TYPE1, .expansion = TVI_AT_START
#define MIDPOINT .method = TVI_TYPE1, .expansion = TVI_AT_MIDPOINT
#define NODES    .method = TVI_TYPE1, .expansion = TVI_AT_NODES
#define TAYLOR   .method = TVI_TAYLOR, .expansion = TVI_AT_START
#define VERLET   .method = TVI_STORMER_VERLET, .expansion = TVI_AT_START

static const options_case options_cases[] = {
    {"sound", {MIDPOINT, .order = 4}, TVI_OK, ""},
    {"all zero", {0}, TVI_EINVAL, "no degree gives"},
    {"order 0", {MIDPOINT}, TVI_EINVAL, "no degree gives"},
    {"order negative", {MIDPOINT, .order = -2}, TVI_EINVAL, "order is negative"},
    {"order negative beside a degree", {MIDPOINT, .order = -2, .degree = 2}, TVI_EINVAL, "order is negative"},
    {"order INT_MAX", {MIDPOINT, .order = INT_MAX}, TVI_EINVAL, "orders of the method are"},
    {"odd order at the midpoint", {MIDPOINT, .order = 5}, TVI_EINVAL, "orders of the method are"},
    {"odd order at the start", {START, .order = 5}, TVI_EINVAL, "orders of the method are"},
    {"odd order of the paper's form", {START, .nodes = TVI_NODES_TRUNCATED, .order = 5}, TVI_OK, ""},
    {"highest order at the start", {START, .order = 2 * TVI_MAX_DEGREE}, TVI_OK, ""},
    {"order too high at the start", {START, .order = 2 * TVI_MAX_DEGREE + 2}, TVI_EINVAL, "no degree gives"},
    {"order too high of the paper's form",
     {START, .nodes = TVI_NODES_TRUNCATED, .order = 101},
     TVI_EINVAL,
     "no degree gives"},
    {"order too high of Taylor", {TAYLOR, .order = TVI_MAX_DEGREE}, TVI_EINVAL, "no degree gives"},
    {"highest order of Taylor", {TAYLOR, .order = TVI_MAX_DEGREE - 1}, TVI_OK, ""},
    {"order 1 of Verlet", {VERLET, .order = 1}, TVI_EINVAL, "orders of the method are"},
    {"order 4 of Verlet", {VERLET, .order = 4}, TVI_EINVAL, "no degree gives"},
    {"degree negative", {MIDPOINT, .order = 4, .degree = -1}, TVI_EINVAL, "degree is negative"},
    {"highest degree", {MIDPOINT, .degree = TVI_MAX_DEGREE}, TVI_OK, ""},
    {"degree above the highest", {MIDPOINT, .degree = TVI_MAX_DEGREE + 1}, TVI_EINVAL, "no such degree"},
    {"degree INT_MAX", {START, .degree = INT_MAX}, TVI_EINVAL, "no such degree"},
    {"degree 1 of Taylor", {TAYLOR, .degree = 1}, TVI_EINVAL, "no such degree"},
    {"degree 2 of Verlet", {VERLET, .degree = 2}, TVI_EINVAL, "no such degree"},
    {"points negative", {MIDPOINT, .order = 4, .quadrature_points = -1}, TVI_EINVAL, "quadrature_points is"},
    {"most points", {MIDPOINT, .order = 4, .quadrature_points = TVI_MAX_DEGREE + 2}, TVI_OK, ""},
    {"points above the most",
     {MIDPOINT, .order = 4, .quadrature_points = TVI_MAX_DEGREE + 3},
     TVI_EINVAL,
     "quadrature_points is"},
    {"points INT_MAX", {MIDPOINT, .order = 4, .quadrature_points = INT_MAX}, TVI_EINVAL, "quadrature_points is"},
    {"one point of Lobatto",
     {MIDPOINT, .degree = 1, .quadrature = TVI_LOBATTO, .quadrature_points = 1},
     TVI_EINVAL,
     "needs more points"},
    {"a trapezoid of 3",
     {MIDPOINT, .order = 2, .quadrature = TVI_TRAPEZOID, .quadrature_points = 3},
     TVI_EINVAL,
     "number of points"},
    {"a rectangle of 2",
     {START, .degree = 1, .quadrature = TVI_RECTANGLE_END, .quadrature_points = 2},
     TVI_EINVAL,
     "number of points"},
    {"Gauss of lower order",
     {MIDPOINT, .order = 4, .quadrature = TVI_GAUSS, .quadrature_points = 1},
     TVI_EINVAL,
     "is of lower order"},
    {"Gauss of the same order", {MIDPOINT, .order = 4, .quadrature = TVI_GAUSS, .quadrature_points = 2}, TVI_OK, ""},
    {"Lobatto of lower order",
     {MIDPOINT, .order = 6, .quadrature = TVI_LOBATTO, .quadrature_points = 3},
     TVI_EINVAL,
     "is of lower order"},
    {"trapezoid of lower order", {MIDPOINT, .order = 4, .quadrature = TVI_TRAPEZOID}, TVI_EINVAL, "is of lower order"},
    {"rectangle of lower order",
     {START, .order = 2, .quadrature = TVI_RECTANGLE_START},
     TVI_EINVAL,
     "is of lower order"},
    {"no method", {.method = (tvi_method)(TVI_STORMER_VERLET + 100), .order = 4}, TVI_EINVAL, "not a tvi_method"},
    {"method negative", {.method = (tvi_method)-1, .order = 4}, TVI_EINVAL, "not a tvi_method"},
    {"no expansion", {.expansion = (tvi_expansion)(TVI_AT_NODES + 100), .order = 4}, TVI_EINVAL, "not a tvi_expansion"},
    {"expansion negative", {.expansion = (tvi_expansion)-1, .order = 4}, TVI_EINVAL, "not a tvi_expansion"},
    {"no node rule", {.nodes = (tvi_nodes)(TVI_NODES_TRUNCATED + 1), .order = 4}, TVI_EINVAL, "not a tvi_nodes"},
    {"node rule negative", {.nodes = (tvi_nodes)-1, .order = 4}, TVI_EINVAL, "not a tvi_nodes"},
    {"no quadrature",
     {.quadrature = (tvi_quadrature)(TVI_RECTANGLE_END + 1), .order = 4},
     TVI_EINVAL,
     "quadrature is not"},
    {"quadrature negative", {.quadrature = (tvi_quadrature)-1, .order = 4}, TVI_EINVAL, "quadrature is not"},
    {"tolerance negative", {MIDPOINT, .order = 4, .tolerance = -1e-10}, TVI_EINVAL, "tolerance is"},
    {"tolerance NaN", {MIDPOINT, .order = 4, .tolerance = NAN}, TVI_EINVAL, "tolerance is"},
    {"tolerance infinite", {MIDPOINT, .order = 4, .tolerance = INFINITY}, TVI_EINVAL, "tolerance is"},
    {"prediction only", {MIDPOINT, .order = 4, .passes = TVI_PREDICT_ONLY}, TVI_OK, ""},
    {"passes below prediction only", {MIDPOINT, .order = 4, .passes = -2}, TVI_EINVAL, "passes is below"},
    {"passes INT_MIN", {MIDPOINT, .order = 4, .passes = INT_MIN}, TVI_EINVAL, "passes is below"},
    {"max_tail NaN", {MIDPOINT, .order = 4, .max_tail = NAN}, TVI_EINVAL, "max_tail is"},
    {"max_tail infinite", {MIDPOINT, .order = 4, .max_tail = INFINITY}, TVI_OK, ""},
    {"max_tail negative", {MIDPOINT, .order = 4, .max_tail = -INFINITY}, TVI_OK, ""},
    {"max_passes negative", {MIDPOINT, .order = 4, .max_passes = -1}, TVI_EINVAL, "max_passes is"},
    {"Taylor at the midpoint",
     {.method = TVI_TAYLOR, .expansion = TVI_AT_MIDPOINT, .order = 4},
     TVI_EUNSUPPORTED,
     "expansion and node rule"},
    {"Taylor with truncated nodes",
     {TAYLOR, .nodes = TVI_NODES_TRUNCATED, .order = 4},
     TVI_EUNSUPPORTED,
     "expansion and node rule"},
    {"Verlet at the midpoint",
     {.method = TVI_STORMER_VERLET, .expansion = TVI_AT_MIDPOINT, .order = 2},
     TVI_EUNSUPPORTED,
     "expansion and node rule"},
    {"Taylor at the end",
     {.method = TVI_TAYLOR, .expansion = TVI_AT_END, .order = 4},
     TVI_EUNSUPPORTED,
     "expansion and node rule"},
    {"type II at the midpoint",
     {.method = TVI_TYPE2, .expansion = TVI_AT_MIDPOINT, .order = 4},
     TVI_EUNSUPPORTED,
     "expansion and node rule"},
    {"type III at both ends",
     {.method = TVI_TYPE3, .expansion = TVI_AT_BOTH_ENDS, .order = 4},
     TVI_EUNSUPPORTED,
     "expansion and node rule"},
    {"Poincare at the start", {.method = TVI_POINCARE, .order = 4}, TVI_EUNSUPPORTED, "expansion and node rule"},
    {"the adjoint of a symmetric method", {MIDPOINT, .order = 4, .compose_adjoint = true}, TVI_OK, ""},
    {"odd order of a composition",
     {START, .nodes = TVI_NODES_TRUNCATED, .order = 5, .compose_adjoint = true},
     TVI_EINVAL,
     "orders of the method are"},
    {"even order of a composition",
     {START, .nodes = TVI_NODES_TRUNCATED, .order = 4, .compose_adjoint = true},
     TVI_OK,
     ""},
    {"lowest order at the nodes", {NODES, .order = 2}, TVI_OK, ""},
    {"highest order at the nodes", {NODES, .order = 2 * TVI_MAX_NODES}, TVI_OK, ""},
    {"order too high at the nodes", {NODES, .order = 2 * TVI_MAX_NODES + 2}, TVI_EINVAL, "no degree gives"},
    {"odd order at the nodes", {NODES, .order = 5}, TVI_EINVAL, "orders of the method are"},
    {"degree too high at the nodes", {NODES, .degree = TVI_MAX_NODES + 1}, TVI_EINVAL, "no such degree"},
    {"truncated at the nodes",
     {NODES, .nodes = TVI_NODES_TRUNCATED, .order = 4},
     TVI_EUNSUPPORTED,
     "expansion and node rule"},
    {"Gauss at the nodes", {NODES, .order = 4, .quadrature = TVI_GAUSS, .quadrature_points = 2}, TVI_OK, ""},
    {"more points than nodes", {NODES, .order = 4, .quadrature_points = 3}, TVI_EINVAL, "quadrature points"},
    {"fewer points than nodes", {NODES, .order = 4, .quadrature_points = 1}, TVI_EINVAL, "quadrature points"},
    {"Lobatto at the nodes", {NODES, .order = 4, .quadrature = TVI_LOBATTO}, TVI_EUNSUPPORTED, "Gauss quadrature"},
    {"type II at the nodes",
     {.method = TVI_TYPE2, .expansion = TVI_AT_NODES, .order = 4},
     TVI_EUNSUPPORTED,
     "expansion and node rule"},
    {"the adjoint at the nodes", {NODES, .order = 4, .compose_adjoint = true}, TVI_OK, ""},
    {"the adjoint of Verlet", {VERLET, .order = 2, .compose_adjoint = true}, TVI_EUNSUPPORTED, "compose_adjoint"},
    {"the adjoint of Taylor", {TAYLOR, .order = 4, .compose_adjoint = true}, TVI_EUNSUPPORTED, "compose_adjoint"},
};

static void expect_resolved(const char *name, const tvi_integrator *integrator, const tvi_options *asked)
{
    const tvi_options *resolved = tvi_integrator_options(integrator);
    ck_assert_msg(resolved->order >= 1 && resolved->degree >= 0 && resolved->degree <= TVI_MAX_DEGREE, "%s", name);
    ck_assert_msg(asked->degree > 0 ? resolved->degree == asked->degree : resolved->order == asked->order, "%s", name);
    if (asked->method == TVI_TAYLOR || asked->method == TVI_STORMER_VERLET) return;
    ck_assert_msg(resolved->quadrature_points >= 1 && resolved->quadrature != TVI_QUADRATURE_AUTO, "%s", name);
}

/* Member by member: a structure has gaps. */
static bool same_options(const tvi_options *a, const tvi_options *b)
{
    return a->method == b->method && a->expansion == b->expansion && a->nodes == b->nodes && a->order == b->order &&
           a->degree == b->degree && a->compose_adjoint == b->compose_adjoint && a->quadrature == b->quadrature &&
           a->quadrature_points == b->quadrature_points && a->tolerance == b->tolerance && a->passes == b->passes &&
           a->max_passes == b->max_passes;
}

/* tvi_options_check and tvi_integrator_create agree, and give the reason and what was asked for. The status. */
static tvi_status check_options(const char *name, const tvi_system *system, const tvi_options *options)
{
    const tvi_options asked = *options;
    const char *const untouched = "untouched", *why = untouched;
    const tvi_status status = tvi_options_check(system, options, &why);
    ck_assert_msg((why == untouched) == (status == TVI_OK) && why && *why, "%s: why", name);
    expect_refusal(name, tvi_options_check(system, options, NULL), status, why);
    char given[64] = "";
    if (status != TVI_OK) snprintf(given, sizeof given, "order = %d, degree = %d", options->order, options->degree);
    expect_refusal(name, tvi_options_check(system, options, NULL), status, given);
    tvi_integrator *integrator = (tvi_integrator *)&(char){0};
    expect(name, tvi_integrator_create(&integrator, system, options), status);
    ck_assert_msg((integrator != NULL) == (status == TVI_OK), "%s: out", name);
    if (status == TVI_OK) expect_resolved(name, integrator, options);
    ck_assert_msg(isnan(asked.tolerance) || same_options(&asked, options), "%s: the options were changed", name);
    tvi_integrator_free(integrator);
    return status;
}

START_TEST(options_by_name)
{
    tvi_system *system = create_form(SEPARABLE);
    for (size_t i = 0; i < sizeof options_cases / sizeof *options_cases; i++) {
        const tvi_options options = options_cases[i].options;
        expect_refusal(options_cases[i].name, check_options(options_cases[i].name, system, &options),
                       options_cases[i].status, options_cases[i].culprit);
    }
    tvi_system_free(system);
}
END_TEST

/* Every combination, at every order up to 8, is a method for the system or is refused for a reason; some are
 * methods. */
START_TEST(options_combined)
{
    int made = 0;
    tvi_system *system = create_form(SEPARABLE);
    for (int expansion = TVI_AT_START; expansion <= TVI_AT_NODES; expansion++)
        for (int nodes = TVI_NODES_ON_CURVE; nodes <= TVI_NODES_TRUNCATED; nodes++)
            for (int rule = TVI_QUADRATURE_AUTO; rule <= TVI_RECTANGLE_END; rule++)
                for (int order = 1; order <= 8; order++)
                    for (int adjoint = 0; adjoint <= 1; adjoint++) {
                        const tvi_options options = {.method = (tvi_method)_i,
                                                     .expansion = (tvi_expansion)expansion,
                                                     .nodes = (tvi_nodes)nodes,
                                                     .quadrature = (tvi_quadrature)rule,
                                                     .order = order,
                                                     .compose_adjoint = adjoint};
                        made += check_options("combination", system, &options) == TVI_OK;
                    }
    ck_assert_int_gt(made, 0);
    tvi_system_free(system);
}
END_TEST

/* Type I needs velocities that the momenta give, types II and III and Poincare a Hamiltonian, Stormer-Verlet a sum of a
 * part of q and one of p; Taylor and the Galerkin curve need nothing. */
static bool serves(const method *m, form of)
{
    const tvi_options options = options_of(m);
    if (options.expansion == TVI_AT_NODES) return true;
    switch (options.method) {
    case TVI_TYPE1: return of != DEGENERATE && of != VORTICES;
    case TVI_TAYLOR: return true;
    case TVI_STORMER_VERLET: return of == SEPARABLE;
    default: return of != GENERAL;
    }
}

START_TEST(methods_and_systems)
{
    tvi_system *system = create_form((form)_i);
    for (int i = 0; i < method_count; i++) {
        const tvi_options options = options_of(&methods[i]);
        expect(methods[i].name, check_options(methods[i].name, system, &options),
               serves(&methods[i], (form)_i) ? TVI_OK : TVI_EUNSUPPORTED);
    }
    tvi_system_free(system);
}
END_TEST

START_TEST(options_arguments)
{
    tvi_system *system = create_form(SEPARABLE);
    const tvi_options options = tvi_options_default();
    const char *why = NULL;
    refused("system", tvi_options_check(NULL, &options, &why), TVI_EINVAL);
    ck_assert_ptr_nonnull(why);
    why = NULL;
    refused("options", tvi_options_check(system, NULL, &why), TVI_EINVAL);
    ck_assert_ptr_nonnull(why);
    refused("system is NULL", tvi_options_check(NULL, NULL, NULL), TVI_EINVAL);
    tvi_integrator *integrator = (tvi_integrator *)&(char){0};
    refused("system", tvi_integrator_create(&integrator, NULL, &options), TVI_EINVAL);
    ck_assert_ptr_null(integrator);
    refused("out", tvi_integrator_create(NULL, system, &options), TVI_EINVAL);
    ck_assert_ptr_null(tvi_integrator_options(NULL));
    ck_assert_ptr_null(tvi_integrator_stats(NULL));
    tvi_integrator_free(NULL);
    tvi_integrator_reset(NULL);
    tvi_system_free(system);
}
END_TEST

static state ten_steps(tvi_integrator *integrator)
{
    state s = {.q = {0.3, 0.5}, .p = {0.7, -0.2}};
    ck_assert_int_eq(tvi_integrate(integrator, 0.1, 10, &s.t, s.q, s.p, NULL, NULL), TVI_OK);
    return s;
}

/* NULL options are the default, and the integrator keeps a copy of those it is given. */
START_TEST(options_kept)
{
    tvi_system *system = create_form(SEPARABLE);
    tvi_integrator *integrator;
    tvi_options options = tvi_options_default();
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_options(integrator)->method, options.method);
    ck_assert_int_eq(tvi_integrator_options(integrator)->expansion, options.expansion);
    ck_assert_int_eq(tvi_integrator_options(integrator)->order, options.order);
    const state by_default = ten_steps(integrator);
    tvi_integrator_free(integrator);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    memset(&options, 0xff, sizeof options);
    const state by_options = ten_steps(integrator);
    tvi_integrator_free(integrator);
    expect_same("the default", &by_options, &by_default);
    tvi_system_free(system);
}
END_TEST

/* Orders of the named methods: from, to, in steps of. */
static const struct {
    const char *name;
    int from, to, by;
} named[] = {
    {"tvi", 1, TVI_MAX_DEGREE, 1},
    {"htvi-right", 1, TVI_MAX_DEGREE, 1},
    {"htvi-left", 1, TVI_MAX_DEGREE, 1},
    {"svhd", 2, 2, 1},
    {"symmetric-tvi", 2, TVI_MAX_DEGREE, 2},
    {"start", 2, 2 * TVI_MAX_DEGREE, 2},
    {"end", 2, 2 * TVI_MAX_DEGREE, 2},
    {"midpoint", 2, 2 * TVI_MAX_DEGREE, 2},
    {"both-ends", 2, 2 * TVI_MAX_DEGREE, 2},
    {"right", 2, 2 * TVI_MAX_DEGREE, 2},
    {"left", 2, 2 * TVI_MAX_DEGREE, 2},
    {"poincare", 2, 2 * TVI_MAX_DEGREE + 2, 2},
    {"galerkin", 2, 2 * TVI_MAX_NODES, 2},
    {"taylor", 1, TVI_MAX_DEGREE - 1, 1},
    {"stormer-verlet", 2, 2, 1},
};

static void check_named(const tvi_system *system, const char *name, int order, bool exists)
{
    tvi_options options, untouched;
    memset(&untouched, 0x5a, sizeof untouched);
    memcpy(&options, &untouched, sizeof options);
    expect_refusal(name, tvi_options_named(name, order, &options), exists ? TVI_OK : TVI_EINVAL, name);
    if (exists) expect(name, check_options(name, system, &options), TVI_OK);
    else ck_assert_msg(memcmp(&options, &untouched, sizeof options) == 0, "%s %d: changed", name, order);
}

START_TEST(options_named)
{
    tvi_system *system = create_form(SEPARABLE);
    for (size_t i = 0; i < sizeof named / sizeof *named; i++) {
        for (int order = -3; order <= 20; order++) {
            const bool in_range = order >= named[i].from && order <= named[i].to;
            check_named(system, named[i].name, order, in_range && (order - named[i].from) % named[i].by == 0);
        }
        check_named(system, named[i].name, named[i].to, true);
        check_named(system, named[i].name, named[i].to + named[i].by, false);
        check_named(system, named[i].name, INT_MAX, false);
        check_named(system, named[i].name, INT_MIN, false);
        refused("options is NULL", tvi_options_named(named[i].name, named[i].from, NULL), TVI_EINVAL);
    }
    static const char *const unknown[] = {"", "Midpoint", "midpoint ", " tvi", "tv", "tvi2", "no such method"};
    for (size_t i = 0; i < sizeof unknown / sizeof *unknown; i++) check_named(system, unknown[i], 4, false);
    tvi_options options;
    refused("name is NULL", tvi_options_named(NULL, 4, &options), TVI_EINVAL);
    tvi_system_free(system);
}
END_TEST

TCase *tcase_options(void)
{
    TCase *tcase = tcase_create("options");
    tcase_add_test(tcase, options_by_name);
    tcase_add_loop_test(tcase, options_combined, TVI_TYPE1, TVI_STORMER_VERLET + 1);
    tcase_add_loop_test(tcase, methods_and_systems, SEPARABLE, FORMS);
    tcase_add_test(tcase, options_arguments);
    tcase_add_test(tcase, options_kept);
    tcase_add_test(tcase, options_named);
    return tcase;
}
