/* test_bits.c - Tests that what a member does depends on no other: not on how many there are, on its place, on the
 * threads, nor on who looks; and it is what an integrator of its own does. */
#include "ensemble.h"

enum { STEPS = 24 };

/* The form and the method of a loop; false where they do not go together. */
static bool open_pair(int i, tvi_system **system, tvi_options *options)
{
    *system = system_of(&forms[i / method_count]);
    if (has_options(*system, &methods[i % method_count], options)) return true;
    tvi_system_free(*system);
    return false;
}

static tvi_ensemble *create(const tvi_system *system, const tvi_options *options, int members, int threads, int first)
{
    tvi_ensemble *ensemble;
    OK(tvi_ensemble_create(&ensemble, system, options, members, threads));
    set_values(ensemble, members, first);
    return ensemble;
}

/* Steps of orbits first .. first + members - 1 with parameters of their own, in two runs. */
static void run(group *c, const tvi_system *system, const tvi_options *options, int members, int threads, int first,
                tvi_ensemble_observer *observer)
{
    tvi_ensemble *ensemble = create(system, options, members, threads, first);
    start_group(c, members, first);
    OK(tvi_ensemble_integrate(ensemble, H, STEPS / 3, c->t, c->q, c->p, c->status, observer, c));
    OK(tvi_ensemble_integrate(ensemble, H, STEPS - STEPS / 3, c->t, c->q, c->p, c->status, observer, c));
    for (int m = 0; m < members; m++) ck_assert_int_eq(c->status[m], TVI_OK);
    tvi_ensemble_free(ensemble);
}

static group of_one, few, many;

START_TEST(members_are_what_they_are_alone)
{
    tvi_system *system;
    tvi_options options;
    if (!open_pair(_i, &system, &options)) return;
    run(&few, system, &options, 21, 1, 0, NULL);
    for (int m = 0; m < few.members; m += 4) {
        run(&of_one, system, &options, 1, 1, m, NULL);
        expect_same(forms[_i / method_count].name, &few, m, &of_one, 0);
    }
    run(&many, system, &options, 9, 1, 5, NULL); /* other lanes, other neighbours */
    for (int m = 0; m < many.members; m++) expect_same("shifted", &many, m, &few, m + 5);
    ck_assert_double_gt(distance(&few, 1, &few, 2), 1e-3); /* they are not all the same */
    tvi_system_free(system);
}
END_TEST

START_TEST(members_are_integrators)
{
    tvi_system *system;
    tvi_options options;
    if (!open_pair(_i, &system, &options)) return;
    run(&few, system, &options, 7, 1, 0, NULL);
    for (int m = 0; m < few.members; m++) {
        alone a = start_alone(system, &options, m);
        start_group(&of_one, 1, m);
        OK(tvi_integrate(a.integrator, H, STEPS, &a.t, a.q, a.p, NULL, NULL));
        (void)group_of(&a, &of_one);
        expect_same(forms[_i / method_count].name, &few, m, &of_one, 0);
        end_alone(&a);
    }
    tvi_system_free(system);
}
END_TEST

static int look(long step, int members, const double t[], const double q[], const double p[], const tvi_status status[],
                void *ctx)
{
    const group *c = ctx;
    ck_assert(members == c->members && t == c->t && q == c->q && p == c->p && status == c->status && step >= 1);
    return 0;
}

static const struct {
    int members, threads;
    tvi_ensemble_observer *observer;
} sizes[] = {{7, 2, NULL},    {7, 1, look},    {64, 1, NULL},  {64, 3, look},
             {MOST, 1, NULL}, {MOST, 2, NULL}, {MOST, 3, NULL}};
enum { SIZES = sizeof sizes / sizeof *sizes };

/* The bits of this number of members, on this number of threads, watched or not, are those of 64 on one. */
START_TEST(neither_number_nor_threads_matter)
{
    tvi_system *system = system_of(&forms[_i / SIZES == 1 ? 2 : 0]);
    tvi_options options;
    const int size = _i % SIZES;
    ck_assert(has_options(system, &methods[_i / SIZES == 2 ? 2 : 0], &options));
    run(&few, system, &options, 64, 1, 0, NULL);
    run(&many, system, &options, sizes[size].members, sizes[size].threads, 0, sizes[size].observer);
    for (int m = 0; m < few.members && m < many.members; m++) expect_same("size", &many, m, &few, m);
    if (many.members == MOST) {
        run(&few, system, &options, 7, 1, MOST - 7, NULL);
        for (int m = 0; m < 7; m++) expect_same("last ones", &many, MOST - 7 + m, &few, m);
    }
    tvi_system_free(system);
}
END_TEST

/* A member whose state is set anew forgets; the others go on as they were. Once more by two passes a step, whose
 * results show what they began with, and so what is left of earlier steps. */
START_TEST(a_new_state_is_the_members_own)
{
    tvi_system *system;
    tvi_options options;
    if (!open_pair(_i / 2, &system, &options)) return;
    if (_i % 2 == 1) options.passes = 2;
    tvi_ensemble *ensemble = create(system, &options, 7, 1, 0);
    start_group(&few, 7, 0);
    OK(tvi_ensemble_integrate(ensemble, H, 8, few.t, few.q, few.p, few.status, NULL, NULL));
    start_group(&of_one, 7, 0);
    few.t[3] = 0;
    for (int i = 0; i < N; i++) few.q[7 * i + 3] = of_one.q[7 * i + 3], few.p[7 * i + 3] = of_one.p[7 * i + 3];
    OK(tvi_ensemble_integrate(ensemble, H, STEPS, few.t, few.q, few.p, few.status, NULL, NULL));
    tvi_ensemble_free(ensemble);
    ensemble = create(system, &options, 7, 1, 0);
    start_group(&many, 7, 0);
    OK(tvi_ensemble_integrate(ensemble, H, STEPS, many.t, many.q, many.p, many.status, NULL, NULL));
    expect_same("set anew", &few, 3, &many, 3);
    OK(tvi_ensemble_integrate(ensemble, H, 8, many.t, many.q, many.p, many.status, NULL, NULL));
    for (int m = 0; m < 7; m++)
        if (m != 3) expect_same("neighbours", &few, m, &many, m);
    tvi_ensemble_free(ensemble);
    tvi_system_free(system);
}
END_TEST

/* With generated code they are others, to roundoff, but of the same kind. */
START_TEST(compiled_members_are_what_they_are_alone)
{
    static const int by[] = {0, 2, 3};
    tvi_system *system = system_of(&forms[0]);
    tvi_options options;
    tvi_compiled *code;
    ck_assert(has_options(system, &methods[by[_i]], &options));
    run(&many, system, &options, 13, 1, 0, NULL);
    OK(tvi_compile(&code, system, &options, &(tvi_compiler){.flags = "-O1", .cache = ""}));
    options.compiled = code;
    run(&few, system, &options, 13, 2, 0, NULL);
    for (int m = 0; m < few.members; m++) {
        run(&of_one, system, &options, 1, 1, m, NULL);
        expect_same("compiled", &few, m, &of_one, 0);
        ck_assert_double_le(distance(&few, m, &many, m), 4e-15);
    }
    tvi_compiled_free(code);
    tvi_system_free(system);
}
END_TEST

Suite *suite_bits(void)
{
    Suite *suite = suite_create("bits");
    TCase *tests = tcase_create("bits");
    const int pairs = form_count * method_count;
    tcase_add_loop_test(tests, members_are_what_they_are_alone, 0, pairs);
    tcase_add_loop_test(tests, members_are_integrators, 0, pairs);
    tcase_add_loop_test(tests, neither_number_nor_threads_matter, 0, 3 * SIZES);
    tcase_add_loop_test(tests, a_new_state_is_the_members_own, 0, 2 * pairs);
    suite_add_tcase(suite, tests);
    TCase *compiled = tcase_create("compiled");
    tcase_add_loop_test(compiled, compiled_members_are_what_they_are_alone, 0, 3);
    suite_add_tcase(suite, compiled);
    return suite;
}
