/* test_states.c - Tests an ensemble as bytes: a run that goes on from them is the one that was not interrupted; those
 * of others are refused. */
#include "ensemble.h"
#include "problems/refusals.h"

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

static void *save(const tvi_ensemble *ensemble, size_t *size)
{
    OK(tvi_ensemble_save(ensemble, NULL, size));
    void *bytes = malloc(*size);
    OK(tvi_ensemble_save(ensemble, bytes, size));
    return bytes;
}

START_TEST(runs_go_on)
{
    tvi_system *system = system_of(&forms[_i / method_count]);
    tvi_options options;
    size_t size;
    tvi_stats stats, of_all;
    if (has_options(system, &methods[_i % method_count], &options)) {
        tvi_ensemble *first = create(system, &options, MEMBERS, 1), *second, *other;
        start(&through);
        go(first, &through);
        void *bytes = save(first, &size);
        go(first, &through);
        OK(tvi_ensemble_create(&second, system, &options, MEMBERS, 3));
        ck_assert_int_eq(tvi_ensemble_last(second, last.t, last.q, last.p, last.status), TVI_EINVAL);
        OK(tvi_ensemble_load(second, bytes, size));
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
        free(bytes);
    }
    tvi_system_free(system);
}
END_TEST

/* States of another ensemble are refused, and change no state. */
START_TEST(others_are_refused)
{
    static const struct {
        int form, method, members;
        const char *text;
    } others[] = {
        {0, 0, MEMBERS - 1, "another size"}, {1, 0, MEMBERS, "another system"}, {0, 1, MEMBERS, "other options"}};
    tvi_options options;
    size_t size, own;
    tvi_system *system = system_of(&forms[0]);
    ck_assert(has_options(system, &methods[0], &options));
    tvi_ensemble *ensemble = create(system, &options, MEMBERS, 1);
    start_group(&through, MEMBERS, 0);
    go(ensemble, &through);
    char *bytes = save(ensemble, &size);
    for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
        tvi_system *base = system_of(&forms[others[k].form]);
        ck_assert(has_options(base, &methods[others[k].method], &options));
        tvi_ensemble *other = create(base, &options, others[k].members, 1);
        refused(others[k].text, tvi_ensemble_load(other, bytes, size), TVI_EINVAL);
        tvi_ensemble_free(other);
        tvi_system_free(base);
    }
    for (size_t at = 0; at < size; at += 1 + size / 97) {
        bytes[at] ^= 1;
        ck_assert_int_eq(tvi_ensemble_load(ensemble, bytes, size), TVI_EINVAL);
        bytes[at] ^= 1;
    }
    refused("damaged", tvi_ensemble_load(ensemble, bytes, size - 1), TVI_EINVAL);
    refused("too few", tvi_ensemble_load(ensemble, bytes, 8), TVI_EINVAL);
    own = size - 1;
    refused("the buffer has", tvi_ensemble_save(ensemble, bytes, &own), TVI_EINVAL);
    OK(tvi_ensemble_last(ensemble, last.t, last.q, last.p, last.status));
    last.members = MEMBERS;
    for (int m = 0; m < MEMBERS; m++) ck_assert_double_eq(distance(&last, m, &through, m), 0);
    /* nor is one of an integrator's */
    tvi_integrator *integrator;
    double t, q[N], p[N];
    int n;
    ck_assert(has_options(system, &methods[0], &options));
    OK(tvi_integrator_create(&integrator, system, &options));
    refused("of an ensemble", tvi_state_load(integrator, bytes, size), TVI_EINVAL);
    refused("of an ensemble", tvi_state_peek(bytes, size, &n, &t, q, p), TVI_EINVAL);
    OK(tvi_state_save(integrator, NULL, &own));
    ck_assert_uint_lt(own, size);
    OK(tvi_state_save(integrator, bytes, &own));
    refused("of an integrator", tvi_ensemble_load(ensemble, bytes, own), TVI_EINVAL);
    tvi_integrator_free(integrator);
    tvi_ensemble_free(ensemble);
    tvi_system_free(system);
    free(bytes);
}
END_TEST

Suite *suite_states(void)
{
    Suite *suite = suite_create("states");
    TCase *tests = tcase_create("states");
    tcase_add_loop_test(tests, runs_go_on, 0, form_count * method_count);
    tcase_add_test(tests, others_are_refused);
    suite_add_tcase(suite, tests);
    return suite;
}
