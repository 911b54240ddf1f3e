/* Steps of generated code that are made in a row: those that are made one by one, to the bit. */
#include "compiled.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 250 }; /* predictions of some are fitted after 64 or 192 */

/* Masses between quartic springs, too many for registers, and two pairs of them on springs of frequency 50. */
enum { LONG = 12 };
static jet springs(const jet q[], jet t, void *ctx)
{
    jet sum = jet_pow(q[0], 4);
    (void)t, (void)ctx;
    for (int i = 0; i < LONG; i++) sum = jet_add(sum, jet_pow(i + 1 < LONG ? jet_sub(q[i + 1], q[i]) : q[i], 4));
    for (int i = 0; i < 4; i += 2) sum = jet_add(sum, jet_mul(625, jet_sqr(jet_sub(q[i + 1], q[i]))));
    return sum;
}
static const double long_q[LONG] = {0.7, 0.72}, long_p[LONG] = {0, 1.4, 0, 0, 0.3};
static const scene long_chain = {.name = "springs", .n = LONG, .potential = springs, .q = long_q, .p = long_p};

typedef struct {
    motion m, middle; /* at the end of the run, and in the middle of its last step */
    tvi_stats stats;
    tvi_status status;
} travel;

/* All steps by one call, or by one each. */
static travel travel_by(const tvi_system *system, const tvi_options *options, const whose *of, long steps, long at_once)
{
    travel made = {.m = motion_start(of->scene)};
    tvi_integrator *integrator;
    motion *m = &made.m, *middle = &made.middle;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, options), TVI_OK);
    for (long k = 0; k < steps && made.status == TVI_OK; k += at_once)
        made.status = tvi_integrate(integrator, of->h, at_once, &m->t, m->q, m->p, NULL, NULL);
    ck_assert_int_eq(tvi_dense(integrator, 0.5, middle->q, middle->p) == TVI_OK, made.status == TVI_OK);
    made.stats = *tvi_integrator_stats(integrator);
    tvi_integrator_free(integrator);
    return made;
}

/* Calls that make many steps make those of many calls, to the bit; where the guard looks at some of them, too. By the
 * widest vectors, where few unknowns stay in registers, or do not. Within a step they are those of the tape but for
 * roundoff; so are the numbers of passes, of which those of the tape are all judged. Two rows are predicted roughly,
 * and one of them takes more passes than are ever made in silence. Of one the tape has fits, but not the code, which
 * takes as many passes a step as the tape before: 608 in 100 steps. */
START_TEST(steps_in_a_row_are_those_one_by_one)
{
    enum { CALLS = 5 };
    static const struct {
        whose of;
        double max_tail;
        long least, most, passes; /* steps; passes more or less than those of the tape */
        long all;                 /* passes at most, where springs or fits change them; 0: any number */
    } rows[] = {{{&scene_kepler, 0.25, false}, 0, STEPS, STEPS, 50, 0},
                {{&scene_kepler, 0.25, false}, 1e-6, 4, 20, 0, 0},
                {{&scene_kepler, 0.75, false}, 0, STEPS, STEPS, 225, 0},
                {{&scene_henon_heiles_12, 0.625, false}, 0, STEPS, STEPS, 75, STEPS * 616 / 100},
                {{&scene_fpu, 0.03125, false}, 0, STEPS, STEPS, 50, 0},
                {{&scene_double_pendulum, 0.0625, false}, 0, STEPS, STEPS, 50, 0},
                {{&scene_kepler, 0.2, true}, 0, STEPS, STEPS, 50, 0},
                {{&scene_henon_heiles_12, 2, false}, 0, STEPS, STEPS, 225, 0},
                {{&scene_fpu, 0.078125, false}, 0, STEPS, STEPS, 50, 13 * STEPS},
                {{&long_chain, 0.078125, false}, 0, STEPS, STEPS, 175, 13 * STEPS},
                {{&scene_nonseparable, 0.25, false}, 0, STEPS, STEPS, 50, STEPS * 72 / 10}};
    static const char *const compilers[] = {NULL, "cc -DGALERKIN_IN_REGISTER=0 -DJET_NARROW=0",
                                            "cc -DGALERKIN_IN_REGISTER=1 -DJET_NARROW=0", "cc -DJET_NARROW=1"};
    enum { ROWS = sizeof rows / sizeof *rows };
    const int own = _i < ROWS ? _i : 0; /* then the first row, in all ways */
    const whose *of = &rows[own].of;
    const tvi_compiler how = {compilers[_i < ROWS ? 0 : _i - ROWS + 1], usual.flags, usual.cache};
    systems its;
    const tvi_system *system = systems_open(of, &its);
    tvi_options options = tvi_options_default();
    tvi_compiled *code;
    options.max_tail = rows[own].max_tail;
    ck_assert_int_eq(tvi_compile(&code, system, &options, &how), TVI_OK);
    options.compiled = code;
    const travel row = travel_by(system, &options, of, STEPS, STEPS / CALLS),
                 single = travel_by(system, &options, of, STEPS, 1);
    ck_assert_mem_eq(&row.m, &single.m, sizeof row.m);
    ck_assert_mem_eq(&row.middle, &single.middle, sizeof row.middle);
    ck_assert_mem_eq(&row.stats, &single.stats, sizeof row.stats);
    ck_assert_int_eq(row.status, single.status);
    options.compiled = NULL;
    const travel tape = travel_by(system, &options, of, row.stats.steps, 1);
    if (row.status == TVI_OK) ck_assert_double_le(motion_difference(of->scene->n, &tape.middle, &row.middle), 1e-9);
    if (row.status == TVI_OK) ck_assert_int_le(labs(row.stats.passes - tape.stats.passes), rows[own].passes);
    if (rows[own].all > 0) ck_assert_int_le(row.stats.passes, rows[own].all);
    ck_assert_int_eq(row.status, rows[own].most < STEPS ? TVI_ETOOLARGE : TVI_OK);
    ck_assert_int_ge(row.stats.steps, rows[own].least);
    ck_assert_int_le(row.stats.steps, rows[own].most);
    tvi_compiled_free(code);
    systems_free(&its);
}
END_TEST

static int go_on(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)step, (void)t, (void)q, (void)p, (void)ctx;
    return 0;
}

/* A run to a time of which nobody is told makes its steps in rows: those that it makes one by one for an observer, to
 * the bit, forth and back, with ends that are steps but for roundoff, and others. */
START_TEST(runs_to_a_time_in_rows)
{
    static const whose rows[] = {
        {&scene_kepler, 0.25, false}, {&scene_kepler, 0.2, true}, {&scene_fpu, 0.03125, false}};
    static const double ends[] = {20, 20.1, 10 * 0.1, 0.01};
    enum { ENDS = sizeof ends / sizeof *ends };
    const whose *of = &rows[_i / (2 * ENDS)];
    const double way = _i % 2 ? -1 : 1, t_end = way * ends[_i / 2 % ENDS];
    systems its;
    const tvi_system *system = systems_open(of, &its);
    tvi_options options = tvi_options_default();
    tvi_compiled *code;
    ck_assert_int_eq(tvi_compile(&code, system, &options, &usual), TVI_OK);
    options.compiled = code;
    motion end[2] = {motion_start(of->scene), motion_start(of->scene)};
    tvi_stats stats[2];
    for (int i = 0; i < 2; i++) {
        tvi_integrator *integrator;
        motion *m = &end[i];
        ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
        for (int part = 1; part <= 2; part++)
            ck_assert_int_eq(
                tvi_integrate_to(integrator, way * of->h, part * t_end, &m->t, m->q, m->p, i > 0 ? go_on : NULL, NULL),
                TVI_OK);
        stats[i] = *tvi_integrator_stats(integrator);
        tvi_integrator_free(integrator);
    }
    ck_assert(end[0].t == 2 * t_end && stats[0].is_compiled);
    ck_assert_mem_eq(&end[0], &end[1], sizeof end[0]);
    ck_assert_mem_eq(&stats[0], &stats[1], sizeof stats[0]);
    tvi_compiled_free(code);
    systems_free(&its);
}
END_TEST

/* A force that ends where the motion goes, and is smooth before: no step of the row is wrong, and the one behind it
 * fails. */
static jet edge(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(q[0], jet_pow(q[0], 3.5));
}

START_TEST(tails_are_of_the_last_step_that_was_made)
{
    tvi_system *system;
    tvi_options options = tvi_options_default();
    tvi_compiled *code;
    tvi_stats stats[2];
    ck_assert_int_eq(tvi_system_potential(&system, 1, NULL, edge, NULL), TVI_OK);
    ck_assert_int_eq(tvi_compile(&code, system, &options, &usual), TVI_OK);
    for (int i = 0; i < 2; i++) {
        motion m = {.q = {1}};
        options.compiled = i > 0 ? code : NULL;
        ck_assert_int_eq(motion_go(system, &options, 0.05, 1000, &m, &stats[i]), TVI_EDOMAIN);
    }
    ck_assert_int_gt(stats[0].steps, 10);
    ck_assert_int_eq(stats[1].steps, stats[0].steps);
    ck_assert_double_gt(stats[0].tail, 1e-12);
    ck_assert_double_lt(stats[0].tail, 1e-3);
    ck_assert_double_eq_tol(stats[1].tail, stats[0].tail, 1e-3 * stats[0].tail);
    ck_assert_double_eq_tol(stats[1].largest_tail, stats[0].largest_tail, 1e-3 * stats[0].largest_tail);
    tvi_compiled_free(code);
    tvi_system_free(system);
}
END_TEST

Suite *suite_rows(void)
{
    Suite *suite = suite_create("rows");
    TCase *tcase = tcase_create("rows");
    tcase_set_timeout(tcase, 600);
    tcase_add_loop_test(tcase, steps_in_a_row_are_those_one_by_one, 0, 14);
    tcase_add_loop_test(tcase, runs_to_a_time_in_rows, 0, 24);
    tcase_add_test(tcase, tails_are_of_the_last_step_that_was_made);
    suite_add_tcase(suite, tcase);
    return suite;
}
