/* test_states.c - Tests the members of an ensemble as texts: a run that goes on from them in another ensemble is the
 * one that was not interrupted. */
#include "ensemble.h"
#include "problems/texts.h"

#include <stdlib.h>
#include <string.h>

enum { MEMBERS = 11, STEPS = 20, BAD = 5 };

static group through, parted, last;

static tvi_ensemble *create(const tvi_system *system, const tvi_options *options, int members, int threads)
{
    tvi_ensemble *ensemble;
    OK(tvi_ensemble_create(&ensemble, system, options, members, threads));
    set_values(ensemble, members, 0);
    return ensemble;
}

static void go(tvi_ensemble *ensemble, group *c)
{
    OK(tvi_ensemble_integrate(ensemble, H, STEPS, c->t, c->q, c->p, c->status, NULL, NULL));
}

/* With a member that has failed. */
static void start(group *c)
{
    start_group(c, MEMBERS, 0);
    c->q[MEMBERS + BAD] = 1e9;
}

START_TEST(runs_go_on)
{
    tvi_system *system = system_of(&forms[_i / method_count]);
    tvi_options options;
    tvi_stats stats, of_all;
    if (has_options(system, &methods[_i % method_count], &options)) {
        tvi_ensemble *first = create(system, &options, MEMBERS, 1), *second, *other;
        start(&through);
        go(first, &through);
        OK(tvi_ensemble_create(&second, system, &options, MEMBERS, 3));
        ck_assert_int_eq(tvi_ensemble_last(second, last.t, last.q, last.p, last.status), TVI_EINVAL);
        last = through;
        move_members(first, second, MEMBERS, last.t, last.q, last.p);
        char *bad = text_of_member(first, BAD, through.t, through.q, through.p); /* it is tried again */
        OK(tvi_ensemble_member_from_text(first, BAD, bad, strlen(bad), through.t, through.q, through.p));
        free(bad);
        go(first, &through);
        start_group(&last, MEMBERS, 0);
        OK(tvi_ensemble_last(second, last.t, last.q, last.p, last.status));
        go(second, &last);
        for (int m = 0; m < MEMBERS; m++) expect_same("after a load", &last, m, &through, m);
        OK(tvi_ensemble_stats(first, &stats));
        OK(tvi_ensemble_stats(second, &of_all));
        ck_assert_int_eq(stats.steps, of_all.steps);
        ck_assert_int_ge(stats.steps, 2 * STEPS * (MEMBERS - 1));
        ck_assert_int_eq(stats.passes, of_all.passes);
        ck_assert_double_eq(stats.largest_tail, of_all.largest_tail);
        /* without what the steps have left it is another run */
        other = create(system, &options, MEMBERS, 1);
        start(&parted);
        go(other, &parted);
        tvi_ensemble_reset(other);
        go(other, &parted);
        int apart = 0;
        for (int m = 0; m < MEMBERS; m++) apart += distance(&parted, m, &through, m) > 0;
        ck_assert_int_ge(apart, 1);
        tvi_ensemble_free(other);
        tvi_ensemble_free(second);
        tvi_ensemble_free(first);
    }
    tvi_system_free(system);
}
END_TEST

/* All members have texts of one size, before their first step and later, and are those of an integrator. */
START_TEST(sizes_are_known)
{
    tvi_system *system = system_of(&forms[_i]);
    tvi_options options;
    size_t before, size;
    ck_assert(has_options(system, &methods[0], &options));
    tvi_ensemble *ensemble = create(system, &options, MEMBERS, 2);
    alone a = start_alone(system, &options, 3);
    start(&through);
    OK(tvi_ensemble_member_to_text(ensemble, 0, through.t, through.q, through.p, NULL, &before));
    go(ensemble, &through);
    for (int m = 0; m < MEMBERS; m++) {
        OK(tvi_ensemble_member_to_text(ensemble, m, through.t, through.q, through.p, NULL, &size));
        ck_assert_uint_eq(size, before);
    }
    OK(tvi_state_to_text(a.integrator, a.t, a.q, a.p, NULL, &size));
    ck_assert_uint_eq(size, before);
    end_alone(&a);
    tvi_ensemble_free(ensemble);
    tvi_system_free(system);
}
END_TEST

Suite *suite_states(void)
{
    Suite *suite = suite_create("states");
    TCase *tests = tcase_create("states");
    tcase_add_loop_test(tests, runs_go_on, 0, form_count * method_count);
    tcase_add_loop_test(tests, sizes_are_known, 0, form_count);
    suite_add_tcase(suite, tests);
    return suite;
}
