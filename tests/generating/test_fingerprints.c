/* test_fingerprints.c - Tests that the history of a state serves the system and the options that it is of, and no
 * others: pairs that differ in one thing. */
#include "method/fingerprint.h"
#include "generating.h"
#include "models.h"
#include "problems/texts.h"

#include <float.h>
#include <stdlib.h>

enum { N = 4 };

/* ROW(name, one, other): functions of the coordinates q and the time t. */
#define PAIRS(ROW)                                                                                                     \
    ROW(operand_of_product, jet_mul(q[0], q[1]), jet_mul(q[0], q[2]))                                                  \
    ROW(operand_of_square, jet_pow(q[0], 4), jet_pow(q[1], 4))                                                         \
    ROW(operand_of_sum, jet_sin(jet_add(q[0], q[1])), jet_sin(jet_add(q[0], q[2])))                                    \
    ROW(operand_of_sum_of_products, PRODUCTS(q[0], 2, q[3]), PRODUCTS(q[0], 2, q[1]))                                  \
    ROW(operand_of_function, jet_sin(q[0]), jet_sin(q[3]))                                                             \
    ROW(operand_of_power, jet_pow(q[1], -1.5), jet_pow(q[2], -1.5))                                                    \
    ROW(dividend, jet_div(q[0], q[1]), jet_div(q[2], q[1]))                                                            \
    ROW(divisor, jet_div(q[0], q[1]), jet_div(q[0], q[2]))                                                             \
    ROW(coefficient, jet_mul(2, jet_mul(q[0], q[1])), jet_mul(3, jet_mul(q[0], q[1])))                                 \
    ROW(coefficient_in_sum, jet_exp(jet_add(q[0], jet_mul(2, q[1]))), jet_exp(jet_add(q[0], jet_mul(3, q[1]))))        \
    ROW(coefficient_in_sum_of_products, PRODUCTS(q[0], 2, q[3]), PRODUCTS(q[0], 2.5, q[3]))                            \
    ROW(sign, jet_mul(q[0], q[1]), jet_neg(jet_mul(q[0], q[1])))                                                       \
    ROW(last_bit, jet_mul(0.25, jet_sqr(q[0])), jet_mul(0.25 + DBL_EPSILON / 4, jet_sqr(q[0])))                        \
    ROW(number, jet_cos(jet_add(q[0], 1)), jet_cos(jet_add(q[0], 2)))                                                  \
    ROW(number_or_none, jet_cos(jet_add(q[0], 1)), jet_cos(jet_add(q[0], q[1])))                                       \
    ROW(constant, jet_div(1, jet_sqr(q[0])), jet_div(2, jet_sqr(q[0])))                                                \
    ROW(exponent, jet_pow(q[0], -1.5), jet_pow(q[0], -2.5))                                                            \
    ROW(integer_exponent, jet_pow(q[0], 3), jet_pow(q[0], 4))                                                          \
    ROW(function, jet_sinh(q[0]), jet_cosh(q[0]))                                                                      \
    ROW(order_of_operands, jet_div(q[0], q[1]), jet_div(q[1], q[0]))                                                   \
    ROW(order_of_forces, jet_mul(q[0], jet_sqr(q[1])), jet_mul(q[1], jet_sqr(q[0])))                                   \
    ROW(use_of_time, jet_mul(q[0], jet_sin(q[1])), jet_mul(q[0], jet_sin(t)))                                          \
    ROW(force_of_time, jet_mul(2, q[0]), jet_mul(t, q[0]))                                                             \
    ROW(time_added, jet_sqr(q[0]), jet_sqr(jet_add(q[0], t)))                                                          \
    ROW(one_term_more, jet_sqr(q[0]), jet_add(jet_sqr(q[0]), jet_sqr(q[1])))
#define PRODUCTS(a, c, b) jet_add(jet_mul(a, q[2]), jet_mul(c, jet_mul(q[1], b)))

typedef jet function(const jet q[], jet t);
#define FUNCTIONS(name, one, other)                                                                                    \
    static jet name##_one(const jet q[], jet t) { return (void)q, (void)t, one; }                                      \
    static jet name##_other(const jet q[], jet t) { return (void)q, (void)t, other; }
PAIRS(FUNCTIONS)
#define PAIR(name, one, other) {#name, {name##_one, name##_other}},
static const struct {
    const char *name;
    function *of[2];
} pairs[] = {PAIRS(PAIR)};
enum { COUNT = sizeof pairs / sizeof *pairs };

/* ---- The forms in which a function f becomes a system ------------------------------------------------------------ */

static void force(const jet q[], jet t, jet F[], void *ctx)
{
    function *const *f = ctx;
    for (int i = 0; i < N; i++) F[i] = i == 1 ? (*f)(q, t) : q[i];
}

static jet potential(const jet q[], jet t, void *ctx)
{
    function *const *f = ctx;
    return (*f)(q, t);
}

/* sum (1 + q_0^2) x_i^2 / 2 + f is not separable, whatever stands for x. */
static jet coupled(const jet q[], const jet x[], jet t, void *ctx)
{
    return jet_add(jet_mul(jet_add(1, jet_sqr(q[0])), jet_mul(0.5, jet_dot(x, x, N))), potential(q, t, ctx));
}

static jet separable(const jet q[], const jet p[], jet t, void *ctx)
{
    return jet_add(jet_mul(0.5, jet_dot(p, p, N)), potential(q, t, ctx));
}

enum { FORCE, POTENTIAL, SEPARABLE, HAMILTONIAN, LAGRANGIAN, FORMS };

static tvi_system *system_of(int form, const double mass[], function *f)
{
    tvi_system *system = NULL;
    const tvi_status status = form == FORCE         ? tvi_system_force(&system, N, mass, force, &f)
                              : form == POTENTIAL   ? tvi_system_potential(&system, N, mass, potential, &f)
                              : form == SEPARABLE   ? tvi_system_hamiltonian(&system, N, separable, &f)
                              : form == HAMILTONIAN ? tvi_system_hamiltonian(&system, N, coupled, &f)
                                                    : tvi_system_lagrangian(&system, N, coupled, &f);
    ck_assert_int_eq(status, TVI_OK);
    return system;
}

/* Whether the history of an integrator of one system is one of the other's. Both are freed. */
static bool is_alike(tvi_system *one, tvi_system *other)
{
    static const double zero[N];
    tvi_integrator *from = integrator_of(one, NULL), *into = integrator_of(other, NULL);
    char *text = text_of_state(from, 0, zero, zero), *own = text_of_state(into, 0, zero, zero);
    const bool is_same = strncmp(history_hash_in(text), history_hash_in(own), 16) == 0;
    free(text);
    free(own);
    tvi_integrator_free(from);
    tvi_integrator_free(into);
    tvi_system_free(one);
    tvi_system_free(other);
    return is_same;
}

START_TEST(other_functions_differ)
{
    for (int form = 0; form < FORMS; form++)
        for (int of = 0; of < 4; of++) {
            function *one = pairs[_i].of[of / 2], *other = pairs[_i].of[of % 2];
            const bool is_same = is_alike(system_of(form, NULL, one), system_of(form, NULL, other));
            ck_assert_msg(is_same == (one == other), "%s %d, form %d", pairs[_i].name, of, form);
        }
}
END_TEST

START_TEST(other_masses_differ)
{
    const double mass[N] = {1, 2.5, 0.4, 3}, same[N] = {1, 2.5, 0.4, 3};
    function *f = pairs[0].of[0];
    ck_assert(is_alike(system_of(POTENTIAL, mass, f), system_of(POTENTIAL, same, f)));
    for (int i = 0; i < N; i++) {
        double other[N];
        for (int j = 0; j < N; j++) other[j] = mass[j] * (i == j ? 1 + DBL_EPSILON : 1);
        ck_assert(!is_alike(system_of(POTENTIAL, mass, f), system_of(POTENTIAL, other, f)));
    }
}
END_TEST

/* The same function of (q, x, t) as a Lagrangian and as a Hamiltonian. */
START_TEST(other_forms_differ)
{
    function *f = pairs[_i].of[0];
    ck_assert(!is_alike(system_of(HAMILTONIAN, NULL, f), system_of(LAGRANGIAN, NULL, f)));
    ck_assert(!is_alike(system_of(HAMILTONIAN, NULL, f), system_of(SEPARABLE, NULL, f)));
    ck_assert(!is_alike(system_of(LAGRANGIAN, NULL, f), system_of(POTENTIAL, NULL, f)));
}
END_TEST

/* ---- Options ----------------------------------------------------------------------------------------------------- */

#define EXPECT_SEEN(field, value)                                                                                      \
    do {                                                                                                               \
        tvi_options other = options;                                                                                   \
        ck_assert(other.field != (value));                                                                             \
        other.field = (value);                                                                                         \
        ck_assert_msg(tvi_options_fingerprint(&other) != of_options, #field);                                          \
    } while (0)

START_TEST(every_option_is_seen)
{
    const tvi_options options = {.order = 4}, same = {.order = 4};
    const uint64_t of_options = tvi_options_fingerprint(&options);
    ck_assert(tvi_options_fingerprint(&same) == of_options);
    EXPECT_SEEN(method, TVI_POINCARE);
    EXPECT_SEEN(expansion, TVI_AT_END);
    EXPECT_SEEN(nodes, TVI_NODES_TRUNCATED);
    EXPECT_SEEN(order, 5);
    EXPECT_SEEN(degree, 1);
    EXPECT_SEEN(compose_adjoint, true);
    EXPECT_SEEN(quadrature, TVI_GAUSS);
    EXPECT_SEEN(quadrature_points, 1);
    EXPECT_SEEN(tolerance, DBL_TRUE_MIN);
    EXPECT_SEEN(passes, TVI_PREDICT_ONLY);
    EXPECT_SEEN(max_passes, 1);
}
END_TEST

Suite *suite_fingerprints(void)
{
    Suite *suite = suite_create("fingerprints");
    TCase *tcase = tcase_create("fingerprints");
    tcase_add_loop_test(tcase, other_functions_differ, 0, COUNT);
    tcase_add_test(tcase, other_masses_differ);
    tcase_add_loop_test(tcase, other_forms_differ, 0, COUNT);
    tcase_add_test(tcase, every_option_is_seen);
    suite_add_tcase(suite, tcase);
    return suite;
}
