/* test_failing.c - Tests that a member that fails keeps its last good state and its status, and harms no other. */
#include "ensemble.h"

#include <math.h>
#include <string.h>

enum { MEMBERS = 19, STEPS = 40 };
static const double LONG_STEP = 0.75;

/* V = |q|^2 / 2 + x^2 y - y^3 / 3 + sqrt(x + 1/2) / 100: beyond the walls the motion escapes, left of x = -1/2 there is
 * none. */
static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet cubic = jet_sub(jet_mul(jet_sqr(q[0]), q[1]), jet_div(jet_pow(q[1], 3), 3));
    const jet wall = jet_mul(0.01, jet_sqrt(jet_add(q[0], 0.5)));
    return jet_add(jet_add(jet_mul(0.5, jet_dot(q, q, N)), cubic), wall);
}

/* Members that fail. */
static const struct {
    int member;
    double q[N], p[N];
} bad[] = {
    {2, {NAN, 0}, {0, 0}},       /* TVI_ENONFINITE */
    {3, {-0.75, 0}, {0, 0}},     /* TVI_EDOMAIN */
    {8, {-0.25, 0}, {-0.75, 0}}, /* runs out of the domain */
    {9, {0, 4}, {0, 4}},         /* escapes */
    {17, {1e200, 0}, {0, 1e200}},
};
enum { BAD = sizeof bad / sizeof *bad };

static bool is_bad(int member)
{
    for (int k = 0; k < BAD; k++)
        if (bad[k].member == member) return true;
    return false;
}

static group with, without, one;

static void spoil(group *c)
{
    for (int k = 0; k < BAD; k++)
        for (int i = 0; i < N; i++) {
            c->q[i * MEMBERS + bad[k].member] = bad[k].q[i];
            c->p[i * MEMBERS + bad[k].member] = bad[k].p[i];
        }
}

static tvi_ensemble *create(const tvi_system *system, const tvi_options *options, int threads)
{
    tvi_ensemble *ensemble;
    OK(tvi_ensemble_create(&ensemble, system, options, MEMBERS, threads));
    return ensemble;
}

/* The member fails as an integrator of its own does: with its status, and with its state. */
static void expect_failure(const tvi_system *system, const tvi_options *options, int k)
{
    const int m = bad[k].member;
    tvi_integrator *integrator;
    OK(tvi_integrator_create(&integrator, system, options));
    one.members = 1;
    one.t[0] = 0;
    memcpy(one.q, bad[k].q, sizeof bad[k].q);
    memcpy(one.p, bad[k].p, sizeof bad[k].p);
    one.status[0] = tvi_integrate(integrator, H, STEPS, &one.t[0], one.q, one.p, NULL, NULL);
    for (int d = 0; d < ROWS * COLUMNS; d++) one.D[d] = with.D[d * MEMBERS + m];
    ck_assert_int_ne(with.status[m], TVI_OK);
    expect_same("failed", &with, m, &one, 0);
    tvi_integrator_free(integrator);
}

START_TEST(failures_stay_where_they_are)
{
    tvi_system *system;
    tvi_options options;
    OK(tvi_system_potential(&system, N, NULL, potential, NULL));
    ck_assert(has_options(system, &methods[_i], &options));
    tvi_ensemble *ensemble = create(system, &options, 2), *sound = create(system, &options, 1);
    start_group(&with, MEMBERS, 0);
    start_group(&without, MEMBERS, 0);
    spoil(&with);
    OK(tvi_ensemble_integrate(ensemble, H, STEPS, with.t, with.q, with.p, with.status, NULL, NULL));
    OK(tvi_ensemble_integrate(sound, H, STEPS, without.t, without.q, without.p, without.status, NULL, NULL));
    for (int m = 0; m < MEMBERS; m++)
        if (!is_bad(m)) expect_same("sound", &with, m, &without, m);
    for (int k = 0; k < BAD; k++) expect_failure(system, &options, k);
    /* they are left as they are by the next run, */
    static group before;
    before = with;
    OK(tvi_ensemble_integrate(ensemble, H, 1, with.t, with.q, with.p, with.status, NULL, NULL));
    for (int k = 0; k < BAD; k++) expect_same("left alone", &with, bad[k].member, &before, bad[k].member);
    /* and go on from another state, as if they had not been before */
    tvi_ensemble_free(sound);
    sound = create(system, &options, 1);
    start_group(&without, MEMBERS, 0);
    OK(tvi_ensemble_integrate(sound, H, 1, without.t, without.q, without.p, without.status, NULL, NULL));
    start_group(&with, MEMBERS, 0);
    OK(tvi_ensemble_integrate(ensemble, H, 1, with.t, with.q, with.p, with.status, NULL, NULL));
    for (int m = 0; m < MEMBERS; m++) expect_same("set anew", &with, m, &without, m);
    tvi_ensemble_free(sound);
    tvi_ensemble_free(ensemble);
    tvi_system_free(system);
}
END_TEST

/* A member that has failed is tried again after a reset, with a step that it can make. */
START_TEST(a_reset_tries_again)
{
    tvi_system *system;
    tvi_options options;
    tvi_ensemble *ensemble;
    OK(tvi_system_potential(&system, N, NULL, potential, NULL));
    ck_assert(has_options(system, &methods[0], &options));
    OK(tvi_ensemble_create(&ensemble, system, &options, 2, 1));
    start_group(&with, 2, 0);
    OK(tvi_ensemble_integrate(ensemble, 40, 1, with.t, with.q, with.p, with.status, NULL, NULL));
    for (int m = 0; m < 2; m++) ck_assert_int_ne(with.status[m], TVI_OK);
    OK(tvi_ensemble_integrate(ensemble, H, 1, with.t, with.q, with.p, with.status, NULL, NULL));
    for (int m = 0; m < 2; m++) ck_assert_int_ne(with.status[m], TVI_OK);
    tvi_ensemble_reset(ensemble);
    OK(tvi_ensemble_integrate(ensemble, H, 1, with.t, with.q, with.p, with.status, NULL, NULL));
    for (int m = 0; m < 2; m++) ck_assert_int_eq(with.status[m], TVI_OK);
    tvi_ensemble_free(ensemble);
    tvi_system_free(system);
}
END_TEST

/* The counts of integrators that are each a member, and the largest tail of each. */
static tvi_stats run_alone(const tvi_system *system, const tvi_options *options, double h, group *all, double tail[])
{
    tvi_stats sum = {0};
    for (int m = 0; m < MEMBERS; m++) {
        alone a = start_alone(system, options, m);
        all->status[m] = tvi_integrate(a.integrator, h, STEPS, &a.t, a.q, a.p, NULL, NULL);
        const tvi_stats *stats = tvi_integrator_stats(a.integrator);
        tail[m] = stats->largest_tail;
        all->t[m] = a.t;
        sum.steps += stats->steps;
        sum.passes += stats->passes;
        sum.largest_tail = fmax(sum.largest_tail, tail[m]);
        end_alone(&a);
    }
    return sum;
}

static tvi_stats run_together(const tvi_system *system, const tvi_options *options, double h, group *all)
{
    tvi_stats stats;
    tvi_ensemble *ensemble = create(system, options, 2);
    set_values(ensemble, MEMBERS, 0);
    start_group(all, MEMBERS, 0);
    OK(tvi_ensemble_integrate(ensemble, h, STEPS, all->t, all->q, all->p, all->status, NULL, NULL));
    OK(tvi_ensemble_stats(ensemble, &stats));
    tvi_ensemble_free(ensemble);
    return stats;
}

/* A form and a method, and its order, if another; the last two have no tails, and passes of the first ones do not
 * converge before a step changes the energy. */
static const int pairs[][3] = {{0, 0}, {2, 0}, {0, 1}, {2, 1}, {0, 2},   {2, 2},
                               {0, 4}, {0, 5}, {2, 5}, {0, 3}, {0, 2, 1}};
enum { PAIRS = sizeof pairs / sizeof *pairs, HAVE_TAILS = PAIRS - 2, LOSE_ENERGY = 4 };

static tvi_system *system_of_pair(int row, tvi_options *options)
{
    tvi_system *system = system_of(&forms[pairs[row][0]]);
    method by = methods[pairs[row][1]];
    if (pairs[row][2] > 0) by.order = pairs[row][2];
    ck_assert(has_options(system, &by, options));
    return system;
}

/* The counts are those of the members, and a step whose tail is too large is refused of the same members. */
START_TEST(counts_and_tails_are_those_of_members)
{
    tvi_options options;
    double tail[MEMBERS];
    tvi_system *system = system_of_pair(_i, &options);
    options.max_tail = -1;
    tvi_stats sum = run_alone(system, &options, LONG_STEP, &without, tail);
    tvi_stats all = run_together(system, &options, LONG_STEP, &with);
    ck_assert_int_eq(all.steps, sum.steps);
    ck_assert(all.largest_tail == sum.largest_tail);
    ck_assert_int_eq(all.passes, sum.passes);
    double least = tail[0];
    for (int m = 1; m < MEMBERS; m++) least = fmin(least, tail[m]);
    options.max_tail = sqrt(least * sum.largest_tail);
    sum = run_alone(system, &options, LONG_STEP, &without, tail);
    all = run_together(system, &options, LONG_STEP, &with);
    int refused = 0;
    for (int m = 0; m < MEMBERS; m++) {
        ck_assert_int_eq(with.status[m], without.status[m]);
        refused += with.status[m] == TVI_ETOOLARGE;
    }
    ck_assert_int_gt(refused, 0);
    ck_assert_int_lt(refused, MEMBERS);
    ck_assert_int_eq(all.steps, sum.steps);
    tvi_system_free(system);
}
END_TEST

/* Steps that are too large by what they do to the energy, whatever their tails: of the same members. */
START_TEST(energies_refuse_the_same_members)
{
    static const double sizes[] = {0.015625, 0.25, 0.75, 1.5, 2, 3};
    tvi_options options;
    double tail[MEMBERS];
    int refused = 0, made = 0;
    tvi_system *system = system_of_pair(_i, &options);
    options.max_tail = 1e300;
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        (void)run_alone(system, &options, sizes[k], &without, tail);
        (void)run_together(system, &options, sizes[k], &with);
        for (int m = 0; m < MEMBERS; m++) {
            ck_assert_int_eq(with.status[m], without.status[m]);
            ck_assert(with.t[m] == without.t[m]);
            refused += with.status[m] == TVI_ETOOLARGE;
            made += with.status[m] == TVI_OK;
        }
    }
    ck_assert_int_gt(refused, 0);
    ck_assert_int_ge(made, MEMBERS);
    tvi_system_free(system);
}
END_TEST

Suite *suite_failing(void)
{
    Suite *suite = suite_create("failing");
    TCase *tests = tcase_create("failing");
    tcase_add_loop_test(tests, failures_stay_where_they_are, 0, method_count);
    tcase_add_test(tests, a_reset_tries_again);
    tcase_add_loop_test(tests, counts_and_tails_are_those_of_members, 0, HAVE_TAILS);
    tcase_add_loop_test(tests, energies_refuse_the_same_members, LOSE_ENERGY, PAIRS);
    suite_add_tcase(suite, tests);
    return suite;
}
