/* test_statement.c - Tests constraints that are refused, what does not serve a constrained system, and what tells one
 * constrained system from another. */
#include "constraints.h"
#include "method/fingerprint.h"
#include "problems/refusals.h"
#include "system/constraint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Constraints that are refused -------------------------------------------------------------------------------- */

static jet foreign; /* a jet of a recording that has ended */

static void keep(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = foreign = jet_sqr(q[0]);
}

static void number(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_sub(q[0], 1);
    value[1] = jet_const(0.5);
}

static void cancelled(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_sub(jet_sin(q[0]), jet_sin(q[0]));
}

static void only_of_t(const jet q[], jet t, jet value[], void *ctx)
{
    (void)q, (void)ctx;
    value[0] = jet_sin(t);
}

static void unset(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[1] = q[0];
}

static void beyond_q(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_add(q[0], q[3]);
}

static void beyond_value(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = value[1] = q[0];
}

static void not_a_number(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_mul(NAN, q[0]);
}

static void outside(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_add(q[0], jet_log(-1));
}

static void of_another(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_add(q[0], foreign);
}

static void line(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_sub(q[0], 1);
}

static jet spring(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(jet_parameter(q[0], 1, 2), jet_dot(q, q, 3));
}

static void another_value(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_sub(q[0], jet_parameter(q[0], 1, 3));
}

static jet scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_exp(q[0]);
}

static const struct {
    const char *name;
    int m;
    tvi_constraint_fn *phi;
    tvi_status status;
    const char *culprit;
} cases[] = {
    {"none", 0, line, TVI_EINVAL, "m = 0"},
    {"less than none", -1, line, TVI_EINVAL, "m = -1"},
    {"too many", 4, line, TVI_EINVAL, "m = 4 constraints are more than n = 3"},
    {"no motion", 3, line, TVI_EINVAL, "m = n = 3: so many constraints leave no motion"},
    {"no function", 1, NULL, TVI_EINVAL, "the function is NULL"},
    {"a number", 2, number, TVI_EINVAL, "phi[1] is a number"},
    {"what cancels", 1, cancelled, TVI_EINVAL, "phi[0] is a number"},
    {"only of t", 1, only_of_t, TVI_EINVAL, "phi[0] is a function of t alone"},
    {"unset", 2, unset, TVI_EINVAL, "phi[0] was not set"},
    {"one of two", 2, line, TVI_EINVAL, "phi[1] was not set"},
    {"beyond q", 1, beyond_q, TVI_EINVAL, "beyond the last one: q[3]"},
    {"beyond value", 1, beyond_value, TVI_EINVAL, "value[1] was set"},
    {"another recording", 1, of_another, TVI_EINVAL, "another recording"},
    {"another value of a parameter", 1, another_value, TVI_EINVAL, "parameter 1 = 3, which is 2 in the system"},
    {"not a number", 1, not_a_number, TVI_ENONFINITE, "not finite"},
    {"no value", 1, outside, TVI_EDOMAIN, "phi is made of jet_log"},
};

START_TEST(constraints_that_are_refused)
{
    tvi_system *base, *kept, *system = (tvi_system *)&base;
    ck_assert_int_eq(tvi_system_potential(&base, 3, NULL, spring, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_constrained(&kept, base, 1, keep, NULL), TVI_OK);
    expect_refusal(cases[_i].name, tvi_system_constrained(&system, base, cases[_i].m, cases[_i].phi, NULL),
                   cases[_i].status, cases[_i].culprit);
    ck_assert_ptr_null(system);
    tvi_system_free(kept);
    tvi_system_free(base);
}
END_TEST

START_TEST(systems_that_are_refused)
{
    tvi_system *base = base_of(&problems[PENDULUM]), *system = system_of(&problems[PENDULUM]), *rescaled, *twice;
    refused("out is NULL", tvi_system_constrained(NULL, base, 1, line, NULL), TVI_EINVAL);
    refused("system is NULL", tvi_system_constrained(&twice, NULL, 1, line, NULL), TVI_EINVAL);
    ck_assert_ptr_null(twice);
    twice = base;
    refused("the system is constrained already", tvi_system_constrained(&twice, system, 1, line, NULL),
            TVI_EUNSUPPORTED);
    ck_assert_ptr_null(twice);
    for (int reversible = 0; reversible <= 1; reversible++) {
        ck_assert_int_eq(reversible ? tvi_system_rescaled_reversible(&rescaled, base, scale, NULL)
                                    : tvi_system_rescaled(&rescaled, base, scale, NULL),
                         TVI_OK);
        twice = base;
        refused("the system is rescaled", tvi_system_constrained(&twice, rescaled, 1, line, NULL), TVI_EUNSUPPORTED);
        ck_assert_ptr_null(twice);
        tvi_system_free(rescaled);
    }
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* ---- What does not serve a constrained system -------------------------------------------------------------------- */

static void drag(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)t, (void)ctx;
    force[0] = jet_neg(v[0]);
    force[1] = jet_neg(v[1]);
}

START_TEST(changes_that_are_refused)
{
    tvi_system *system = system_of(&problems[PENDULUM]), *out = system;
    refused("a constrained system is not rescaled", tvi_system_rescaled(&out, system, scale, NULL), TVI_EUNSUPPORTED);
    ck_assert_ptr_null(out);
    out = system;
    refused("a constrained system is not rescaled", tvi_system_rescaled_reversible(&out, system, scale, NULL),
            TVI_EUNSUPPORTED);
    ck_assert_ptr_null(out);
    out = system;
    refused("drive it first", tvi_system_driven(&out, system, drag, NULL), TVI_EUNSUPPORTED);
    ck_assert_ptr_null(out);
    tvi_system_free(system);
}
END_TEST

/* All methods but "galerkin" and "stormer-verlet", and numbers of passes that the user chooses. */
START_TEST(methods_that_are_refused)
{
    static const struct {
        const char *name;
        int order;
    } methods[] = {{"midpoint", 8}, {"start", 4},    {"end", 4},    {"both-ends", 4}, {"right", 4},
                   {"left", 4},     {"poincare", 4}, {"taylor", 8}, {"tvi", 4},       {"svhd", 2}};
    tvi_system *system = system_of(&problems[_i]);
    tvi_options options;
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        ck_assert_int_eq(tvi_options_named(methods[i].name, methods[i].order, &options), TVI_OK);
        refused("a constrained system is for galerkin", tvi_options_check(system, &options, NULL), TVI_EUNSUPPORTED);
    }
    ck_assert_int_eq(tvi_options_named("galerkin", 8, &options), TVI_OK);
    ck_assert_int_eq(tvi_options_check(system, &options, NULL), TVI_OK);
    options.passes = 3;
    refused("as many passes as it needs", tvi_options_check(system, &options, NULL), TVI_EUNSUPPORTED);
    options.passes = TVI_PREDICT_ONLY;
    refused("as many passes as it needs", tvi_options_check(system, &options, NULL), TVI_EUNSUPPORTED);
    tvi_system_free(system);
}
END_TEST

/* ---- What a constrained system is -------------------------------------------------------------------------------- */

START_TEST(counts)
{
    tvi_system *base = base_of(&problems[_i]), *system = system_of(&problems[_i]);
    ck_assert_int_eq(tvi_system_constraints(NULL), 0);
    ck_assert_int_eq(tvi_system_constraints(base), 0);
    ck_assert_int_eq(tvi_system_constraints(system), problems[_i].m);
    ck_assert_int_eq(tvi_system_dimension(system), problems[_i].n);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* The energy and the velocities are those of the base, to the bit. */
START_TEST(base_stays)
{
    const problem *of = &problems[_i];
    tvi_system *base = base_of(of), *system = system_of(of);
    double v[MOST_N], of_base[MOST_N], H = 0, H_of_base = 0;
    ck_assert_int_eq(tvi_velocity(system, of->t, of->q, of->p, v), TVI_OK);
    ck_assert_int_eq(tvi_velocity(base, of->t, of->q, of->p, of_base), TVI_OK);
    ck_assert(memcmp(v, of_base, (size_t)of->n * sizeof *v) == 0);
    ck_assert_int_eq(tvi_energy(system, of->t, of->q, of->p, &H), of->has_energy ? TVI_OK : TVI_EUNSUPPORTED);
    if (of->has_energy) ck_assert_int_eq(tvi_energy(base, of->t, of->q, of->p, &H_of_base), TVI_OK);
    ck_assert(H == H_of_base);
    ck_assert_int_eq(system->form, base->form);
    ck_assert_int_eq(system->is_driven, base->is_driven);
    ck_assert_int_eq(system->has_masses, base->has_masses);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

static void longer_rod(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_sub(jet_dot(q, q, 2), 4);
}

/* The hash of a state has the constraints. */
START_TEST(fingerprints)
{
    tvi_system *base = base_of(&problems[PENDULUM]), *system = system_of(&problems[PENDULUM]),
               *again = system_of(&problems[PENDULUM]), *longer;
    ck_assert_int_eq(tvi_system_constrained(&longer, base, 1, longer_rod, NULL), TVI_OK);
    ck_assert_uint_eq(tvi_system_fingerprint(system), tvi_system_fingerprint(again));
    ck_assert_uint_ne(tvi_system_fingerprint(system), tvi_system_fingerprint(base));
    ck_assert_uint_ne(tvi_system_fingerprint(system), tvi_system_fingerprint(longer));
    tvi_system_free(longer);
    tvi_system_free(again);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* G has the entries that are not 0 everywhere. */
START_TEST(pattern)
{
    tvi_system *system = system_of(&problems[DOUBLE_PENDULUM]);
    const tvi_constraints *constraints = system->constraints;
    static const int column[] = {0, 1, 0, 1, 2, 3};
    ck_assert_int_eq(constraints->entry_count, 6);
    ck_assert_int_eq(constraints->row_end[0], 2);
    ck_assert_int_eq(constraints->row_end[1], 6);
    for (int e = 0; e < 6; e++) ck_assert_int_eq(constraints->column[e], column[e]);
    tvi_system_free(system);
}
END_TEST

/* The tapes against each other, at a state and a direction: curvature by differences of G, along d. */
START_TEST(tapes)
{
    const problem *of = &problems[_i];
    tvi_system *system = system_of(of);
    const tvi_constraints *c = system->constraints;
    const int n = of->n, m = of->m;
    const double mu[] = {0.7, -1.3}, h = 1e-3, *d = of->p;
    double *values = calloc((size_t)c->values->slot_count, sizeof *values);
    double *curvature = calloc((size_t)c->curvature->slot_count, sizeof *curvature);
    jet_tape_write_constants(c->values, values, 1, 1);
    jet_tape_write_constants(c->curvature, curvature, 1, 1);
    double wanted[MOST_N + MOST_M] = {0};
    static const double weight[] = {1, -8, 0, 8, -1}; /* of differences of the fourth order, over 12 h */
    for (int k = -2; k <= 2; k++) {
        for (int i = 0; i < n; i++) values[i] = of->q[i] + k * h * d[i];
        if (c->values->input_count > n) values[n] = of->t;
        ck_assert(jet_sweep_values(c->values, values, 1));
        for (int row = 0, e = 0; row < m; row++)
            for (; e < c->row_end[row]; e++) {
                const double rate = weight[k + 2] * values[c->values->output_slot[m + e]] / (12 * h);
                wanted[c->column[e]] += mu[row] * rate;
                wanted[n + row] += 0.5 * d[c->column[e]] * rate;
            }
    }
    for (int i = 0; i < n; i++) curvature[i] = of->q[i], curvature[n + i] = d[i];
    for (int row = 0; row < m; row++) curvature[2 * n + row] = mu[row];
    if (c->curvature->input_count > 2 * n + m) curvature[2 * n + m] = of->t;
    ck_assert(jet_sweep_values(c->curvature, curvature, 1));
    for (int i = 0; i < n + m; i++)
        ck_assert_msg(fabs(curvature[c->curvature->output_slot[i]] - wanted[i]) <= 1e-9, "%s: %d: %g, not %g", of->name,
                      i, curvature[c->curvature->output_slot[i]], wanted[i]);
    free(values);
    free(curvature);
    tvi_system_free(system);
}
END_TEST

Suite *suite_statement(void)
{
    Suite *suite = suite_create("statement");
    TCase *tests = tcase_create("statement");
    tcase_add_loop_test(tests, constraints_that_are_refused, 0, (int)(sizeof cases / sizeof *cases));
    tcase_add_test(tests, systems_that_are_refused);
    tcase_add_test(tests, changes_that_are_refused);
    tcase_add_loop_test(tests, methods_that_are_refused, 0, problem_count);
    tcase_add_loop_test(tests, counts, 0, problem_count);
    tcase_add_loop_test(tests, base_stays, 0, problem_count);
    tcase_add_test(tests, fingerprints);
    tcase_add_test(tests, pattern);
    tcase_add_loop_test(tests, tapes, 0, problem_count);
    suite_add_tcase(suite, tests);
    return suite;
}
