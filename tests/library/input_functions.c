/* input_functions.c - Tests functions that make no system: numbers that have no value, jets that are kept or mixed,
 * outputs that are not set. The contracts are those of jet.h and tvi.h. */
#include "input.h"

#include <limits.h>
#include <math.h>
#include <string.h>

/* ---- Numbers that have no value ---------------------------------------------------------------------------------- */

typedef jet make_jet(jet x, jet other);

typedef struct {
    const char *name;
    make_jet *make;
    tvi_status status;
    const char *culprit;
} function_case;

/* name, value as a function of the jet x, status of the system whose function returns it, what tvi_last_error names */
#define NO_VALUE_LIST(ROW)                                                                                             \
    ROW(nan_constant, jet_const(NAN), TVI_ENONFINITE, "not finite")                                                    \
    ROW(infinite_constant, jet_const(-INFINITY), TVI_ENONFINITE, "not finite")                                         \
    ROW(nan_term, jet_add(x, NAN), TVI_ENONFINITE, "not finite")                                                       \
    ROW(nan_factor, jet_mul(x, NAN), TVI_ENONFINITE, "not finite")                                                     \
    ROW(infinite_factor, jet_mul(INFINITY, x), TVI_ENONFINITE, "not finite")                                           \
    ROW(infinite_divisor, jet_div(x, INFINITY), TVI_ENONFINITE, "not finite")                                          \
    ROW(nan_exponent, jet_pow(x, NAN), TVI_ENONFINITE, "not finite")                                                   \
    ROW(infinite_exponent, jet_pow(x, INFINITY), TVI_ENONFINITE, "not finite")                                         \
    ROW(nan_exponent_of_number, jet_pow(2, NAN), TVI_ENONFINITE, "not finite")                                         \
    ROW(overflow_of_product, jet_mul(1e200, 1e200), TVI_ENONFINITE, "not finite")                                      \
    ROW(overflow_of_factor, jet_mul(1e200, jet_mul(1e200, x)), TVI_ENONFINITE, "not finite")                           \
    ROW(overflow_of_number, jet_add(DBL_MAX, DBL_MAX), TVI_ENONFINITE, "not finite")                                   \
    ROW(overflow_of_exp, jet_exp(1000), TVI_ENONFINITE, "not finite")                                                  \
    ROW(overflow_of_pow, jet_pow(10, 400), TVI_ENONFINITE, "not finite")                                               \
    ROW(log_of_negative, jet_log(-1), TVI_EDOMAIN, "jet_log, which has")                                               \
    ROW(log_of_zero, jet_log(0), TVI_EDOMAIN, "jet_log, which has")                                                    \
    ROW(sqrt_of_negative, jet_sqrt(-1), TVI_EDOMAIN, "jet_sqrt, which has")                                            \
    ROW(sqrt_of_zero, jet_sqrt(0), TVI_EDOMAIN, "jet_sqrt, which has")                                                 \
    ROW(asin_of_one, jet_asin(1), TVI_EDOMAIN, "jet_asin, which has")                                                  \
    ROW(asin_of_minus_two, jet_asin(-2), TVI_EDOMAIN, "jet_asin, which has")                                           \
    ROW(acos_of_minus_one, jet_acos(-1), TVI_EDOMAIN, "jet_acos, which has")                                           \
    ROW(acos_of_two, jet_acos(2), TVI_EDOMAIN, "jet_acos, which has")                                                  \
    ROW(acosh_of_one, jet_acosh(1), TVI_EDOMAIN, "jet_acosh, which has")                                               \
    ROW(atanh_of_one, jet_atanh(1), TVI_EDOMAIN, "jet_atanh, which has")                                               \
    ROW(angle_of_zero, jet_atan2(0, 0), TVI_EDOMAIN, "jet_atan2, which has")                                           \
    ROW(hypot_of_zero, jet_hypot(0, 0), TVI_EDOMAIN, "jet_hypot, which has")                                           \
    ROW(hypot_with_nan, jet_hypot(x, NAN), TVI_ENONFINITE, "not finite")                                               \
    ROW(overflow_of_hypot, jet_hypot(DBL_MAX, DBL_MAX), TVI_ENONFINITE, "not finite")                                  \
    ROW(fraction_of_zero, jet_pow(0, 1.5), TVI_EDOMAIN, "jet_pow, which has")                                          \
    ROW(fraction_of_negative, jet_pow(-1, 0.5), TVI_EDOMAIN, "jet_pow, which has")                                     \
    ROW(inverse_of_zero, jet_pow(0, -1), TVI_EDOMAIN, "jet_pow, which has")                                            \
    ROW(number_by_zero, jet_div(1, 0), TVI_EDOMAIN, "jet_div, which has no power series at 0")                         \
    ROW(zero_by_zero, jet_div(0, 0), TVI_EDOMAIN, "jet_div, which has no power series at 0")                           \
    ROW(jet_by_zero, jet_div(x, 0), TVI_EDOMAIN, "jet_div, which has no power series at 0")                            \
    ROW(jet_by_minus_zero, jet_div(x, -0.0), TVI_EDOMAIN, "jet_div, which has no power series at -0")

/* Operations on a jet `other` that poisons whatever it enters, even where its value would not matter. */
#define POISONED_LIST(ROW)                                                                                             \
    ROW(other_itself, other)                                                                                           \
    ROW(other_plus, jet_add(other, x))                                                                                 \
    ROW(plus_other, jet_add(x, other))                                                                                 \
    ROW(plus_other_number, jet_add(1, other))                                                                          \
    ROW(other_minus, jet_sub(other, x))                                                                                \
    ROW(other_minus_itself, jet_sub(other, other))                                                                     \
    ROW(other_times, jet_mul(other, x))                                                                                \
    ROW(times_other, jet_mul(x, other))                                                                                \
    ROW(zero_times_other, jet_mul(0, other))                                                                           \
    ROW(other_times_zero, jet_mul(other, 0))                                                                           \
    ROW(other_over, jet_div(other, x))                                                                                 \
    ROW(over_other, jet_div(x, other))                                                                                 \
    ROW(zero_over_other, jet_div(0, other))                                                                            \
    ROW(other_over_itself, jet_div(other, other))                                                                      \
    ROW(other_to_the_0, jet_pow(other, 0))                                                                             \
    ROW(other_to_the_1, jet_pow(other, 1))                                                                             \
    ROW(other_to_the_5, jet_pow(other, 5))                                                                             \
    ROW(other_to_the_half, jet_pow(other, 0.5))                                                                        \
    ROW(other_inverse, jet_pow(other, -1))                                                                             \
    ROW(other_to_the_1_5, jet_pow(other, 1.5))                                                                         \
    ROW(sum_with_other, jet_sum((const jet[]){x, other, x}, 3))                                                        \
    ROW(dot_with_other, jet_dot((const jet[]){x, x}, (const jet[]){x, other}, 2))                                      \
    ROW(dot_zero_other, jet_dot((const jet[]){x, other}, (const jet[]){x, jet_const(0)}, 2))                           \
    ROW(neg_other, jet_neg(other))                                                                                     \
    ROW(sqr_other, jet_sqr(other))                                                                                     \
    ROW(sqrt_other, jet_sqrt(other))                                                                                   \
    ROW(exp_other, jet_exp(other))                                                                                     \
    ROW(log_other, jet_log(other))                                                                                     \
    ROW(sin_other, jet_sin(other))                                                                                     \
    ROW(cos_other, jet_cos(other))                                                                                     \
    ROW(tan_other, jet_tan(other))                                                                                     \
    ROW(asin_other, jet_asin(other))                                                                                   \
    ROW(acos_other, jet_acos(other))                                                                                   \
    ROW(atan_other, jet_atan(other))                                                                                   \
    ROW(sinh_other, jet_sinh(other))                                                                                   \
    ROW(cosh_other, jet_cosh(other))                                                                                   \
    ROW(tanh_other, jet_tanh(other))                                                                                   \
    ROW(asinh_other, jet_asinh(other))                                                                                 \
    ROW(acosh_other, jet_acosh(other))                                                                                 \
    ROW(atanh_other, jet_atanh(other))                                                                                 \
    ROW(erf_other, jet_erf(other))                                                                                     \
    ROW(angle_of_other, jet_atan2(other, x))                                                                           \
    ROW(angle_to_other, jet_atan2(2, other))                                                                           \
    ROW(hypot_with_other, jet_hypot(x, other))

#define MAKE(name, value)                                                                                              \
    static jet name(jet x, jet other)                                                                                  \
    {                                                                                                                  \
        (void)x, (void)other;                                                                                          \
        return value;                                                                                                  \
    }
#define MAKE_OF_FOUR(name, value, status, culprit) MAKE(name, value)
#define ROW(name, value)                           {#name, name, TVI_OK, ""}, /* the status is that of `other` */
#define ROW_OF_FOUR(name, value, status, culprit)  {#name, name, status, culprit},
NO_VALUE_LIST(MAKE_OF_FOUR)
POISONED_LIST(MAKE)
static const function_case no_value[] = {NO_VALUE_LIST(ROW_OF_FOUR)};
static const function_case poisoned[] = {POISONED_LIST(ROW)};
enum { NO_VALUE_COUNT = sizeof no_value / sizeof *no_value, POISONED_COUNT = sizeof poisoned / sizeof *poisoned };

/* The operands of the functions below. */
typedef struct {
    make_jet *make;
    jet other;
} recipe;

static void made_force(const jet q[], jet t, jet force[], void *ctx)
{
    const recipe *r = ctx;
    (void)t;
    force[0] = q[1];
    force[1] = r->make(q[0], r->other);
}

static jet made_potential(const jet q[], jet t, void *ctx)
{
    const recipe *r = ctx;
    (void)t;
    return r->make(q[0], r->other);
}

/* A kinetic energy and the value. */
static jet made_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return jet_add(jet_mul(0.5, jet_dot(v, v, 2)), made_potential(q, t, ctx));
}

static jet made_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    return jet_add(jet_mul(p[0], p[1]), made_potential(q, t, ctx));
}

static void expect_function(const char *what, make_jet *make, jet other, tvi_status wanted, const char *culprit)
{
    static const functions made = {made_force, made_potential, made_lagrangian, made_hamiltonian};
    recipe r = {make, other};
    for (statement by = FORCE; by < STATEMENTS; by++) expect_system(what, by, 2, NULL, &made, &r, wanted, culprit);
}

START_TEST(functions_without_value)
{
    for (int i = 0; i < NO_VALUE_COUNT; i++)
        expect_function(no_value[i].name, no_value[i].make, jet_const(0), no_value[i].status, no_value[i].culprit);
}
END_TEST

/* The first reason goes through every operation, and what is not returned does not matter. */
START_TEST(poison_goes_on)
{
    for (int i = 0; i < POISONED_COUNT; i++) {
        expect_function(poisoned[i].name, poisoned[i].make, jet_log(-1), TVI_EDOMAIN,
                        "jet_log, which has no power series at -1");
        expect_function(poisoned[i].name, poisoned[i].make, jet_mul(1e200, 1e200), TVI_ENONFINITE, "not finite");
    }
    expect_function("sound", sqr_other, jet_const(2), TVI_OK, "");
}
END_TEST

static jet first_of(jet x, jet other)
{
    (void)jet_exp(other);
    return x;
}

START_TEST(unused_poison) { expect_function("unused", first_of, jet_log(-1), TVI_OK, ""); }
END_TEST

/* Keeps a jet of its recording in ctx. */
static jet keeping(const jet q[], jet t, void *ctx)
{
    (void)t;
    jet *kept = ctx;
    *kept = jet_sin(q[0]);
    return jet_add(jet_mul(jet_sqr(q[0]), jet_sqr(q[1])), *kept);
}

static state ten_steps(const tvi_system *system)
{
    tvi_integrator *integrator;
    state s = {.q = {0.3, 0.5}, .p = {0.7, -0.2}};
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrate(integrator, 0.1, 10, &s.t, s.q, s.p, NULL, NULL), TVI_OK);
    tvi_integrator_free(integrator);
    return s;
}

/* A jet kept beyond its call is refused in every operation, and the closed recording that it belongs to is as it
 * was. */
START_TEST(kept_jets)
{
    jet kept;
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 2, NULL, keeping, &kept), TVI_OK);
    const state before = ten_steps(system);
    for (int i = 0; i < POISONED_COUNT; i++)
        expect_function(poisoned[i].name, poisoned[i].make, kept, TVI_EINVAL, "another recording");
    const state after = ten_steps(system);
    expect_same("a closed recording", &after, &before);
    tvi_system_free(system);
}
END_TEST

/* A function that makes a system within: jets of two open recordings are at hand. */
typedef struct {
    make_jet *make;
    tvi_system *inner;
    tvi_status inner_status;
    jet inner_jet;
    jet outer_jet;
    bool returns_inner;
} nesting;

static jet inner_potential(const jet q[], jet t, void *ctx)
{
    nesting *nest = ctx;
    (void)t;
    nest->inner_jet = jet_mul(q[0], q[1]);
    return nest->make ? nest->make(q[0], nest->outer_jet) : nest->inner_jet;
}

static jet outer_potential(const jet q[], jet t, void *ctx)
{
    nesting *nest = ctx;
    (void)t;
    nest->outer_jet = jet_exp(q[0]);
    nest->inner_status = tvi_system_potential(&nest->inner, 2, NULL, inner_potential, nest);
    return nest->returns_inner ? jet_add(q[0], nest->inner_jet) : jet_mul(q[0], nest->outer_jet);
}

static void expect_nesting(const char *what, nesting nest, tvi_status outer, tvi_status inner)
{
    tvi_system *system = NOT_NULL;
    expect_refusal(what, tvi_system_potential(&system, 2, NULL, outer_potential, &nest), outer, "another recording");
    expect_status(what, nest.inner_status, inner);
    ck_assert((system != NULL) == (outer == TVI_OK));
    ck_assert((nest.inner != NULL) == (inner == TVI_OK));
    tvi_system_free(nest.inner);
    tvi_system_free(system);
}

/* Operations on an outer jet whose result is a number, which may pass from one recording to another. */
static bool makes_number(make_jet *make)
{
    static make_jet *const numbers[] = {other_minus_itself, zero_times_other, other_times_zero,
                                        zero_over_other,    other_to_the_0,   dot_zero_other};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (make == numbers[i]) return true;
    return false;
}

START_TEST(two_recordings)
{
    expect_nesting("apart", (nesting){0}, TVI_OK, TVI_OK);
    expect_nesting("the inner jet in the outer function", (nesting){.returns_inner = true}, TVI_EINVAL, TVI_OK);
    for (int i = 0; i < POISONED_COUNT; i++)
        expect_nesting(poisoned[i].name, (nesting){.make = poisoned[i].make}, TVI_OK,
                       makes_number(poisoned[i].make) ? TVI_OK : TVI_EINVAL);
}
END_TEST

/* Sets the outputs that ctx names; reads one that is not set where ctx is negative. */
static void unset_force(const jet q[], jet t, jet force[], void *ctx)
{
    const int set = *(const int *)ctx;
    (void)t;
    for (int i = 0; i < 2; i++)
        if (set & (1 << i)) force[i] = q[i];
    if (set < 0) force[0] = jet_mul(0, force[0]);
}

START_TEST(unset_outputs)
{
    static const struct {
        int set;
        tvi_status status;
        const char *culprit;
    } cases[] = {
        {0, TVI_EINVAL, "force[0]"}, {1, TVI_EINVAL, "force[1]"}, {2, TVI_EINVAL, "force[0]"}, {3, TVI_OK, ""}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        tvi_system *system = NOT_NULL;
        int set = cases[i].set;
        expect_refusal("unset", tvi_system_force(&system, 2, NULL, unset_force, &set), cases[i].status,
                       cases[i].culprit);
        ck_assert((system != NULL) == (cases[i].status == TVI_OK));
        tvi_system_free(system);
    }
    tvi_system *system = NOT_NULL;
    refused("force[0] was not set", tvi_system_force(&system, 2, NULL, unset_force, &(int){INT_MIN | 2}), TVI_EINVAL);
    ck_assert_ptr_null(system);
}
END_TEST

/* Memory of the stack may look like a jet that was never set: the function is refused, whatever it contains. */
static jet stale_potential(const jet q[], jet t, void *ctx)
{
    (void)t;
    const jet stale = {0, ctx};
    return jet_add(stale, q[0]);
}

START_TEST(unset_jets)
{
    for (int byte = 0; byte < 256; byte += 51) {
        void *memory[32] = {NULL};
        memset(memory + 2, byte, sizeof memory - 2 * sizeof *memory);
        tvi_system *system = NOT_NULL;
        refused("potential was not set", tvi_system_potential(&system, 2, NULL, stale_potential, memory), TVI_EINVAL);
        ck_assert_ptr_null(system);
    }
}
END_TEST

/* Lagrangians whose L_vv is singular: by what they are made of, or not seen when they are made. */
static jet linear_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_mul(q[0], v[1]), jet_sqr(q[1]));
}

static jet half_a_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(jet_exp(q[1]), jet_sqr(v[0]));
}

static jet static_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)v;
    return harmonic(q, t, ctx);
}

START_TEST(singular_lagrangians)
{
    static tvi_lagrangian_fn *const singular[] = {linear_lagrangian, half_a_lagrangian, static_lagrangian};
    for (size_t i = 0; i < sizeof singular / sizeof *singular; i++)
        expect_system("singular", LAGRANGIAN, 2, NULL, &(functions){.lagrangian = singular[i]}, NULL, TVI_ESINGULAR,
                      "L_vv");
    expect_system("mixed", LAGRANGIAN, 2, NULL, &(functions){.lagrangian = mixed_lagrangian}, NULL, TVI_OK, "");
}
END_TEST

/* ---- The cases --------------------------------------------------------------------------------------------------- */

TCase *tcase_functions(void)
{
    TCase *tcase = tcase_create("functions");
    tcase_add_test(tcase, functions_without_value);
    tcase_add_test(tcase, poison_goes_on);
    tcase_add_test(tcase, unused_poison);
    tcase_add_test(tcase, kept_jets);
    tcase_add_test(tcase, two_recordings);
    tcase_add_test(tcase, unset_outputs);
    tcase_add_test(tcase, unset_jets);
    tcase_add_test(tcase, singular_lagrangians);
    return tcase;
}
