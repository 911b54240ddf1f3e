/* test_lanes.c - what steps in lanes must not lose beside those of one member: the rule that ends the passes, and what
 * states and increments have in their second parts. */
#include "ensemble.h"
#include "galerkin/batch_loops.h"
#include "galerkin/passes.h"
#include "problems/galerkin_tables.h"
#include "problems/random.h"

#include <math.h>
#include <string.h>

/* ---- Verdicts ---------------------------------------------------------------------------------------------------- */

enum { WIDTH = 8, SEQUENCES = 2000, PASSES = 30 };

static const galerkin_batch_loops *const loops_of[JET_ISA_COUNT] = {
    [jet_isa_base] = &tvi_galerkin_batch_loops_base,
#ifdef __x86_64__
    [jet_isa_avx2] = &tvi_galerkin_batch_loops_avx2,
    [jet_isa_avx512] = &tvi_galerkin_batch_loops_avx512,
#endif
};

/* Sizes of passes: some contract much, some little, some not, some repeat themselves, and few are no numbers. */
static double next_size(double size, uint64_t *bits)
{
    const double what = number_of(bits), much = number_of(bits);
    return what < 0.001 ? NAN : what < 0.1 ? size : what < 0.2 ? size * 4 * much : size * pow(10, -20 * much * what);
}

typedef struct {
    double size[WIDTH], before[WIDTH], part[WIDTH], slowest[WIDTH], shown[WIDTH], count[WIDTH], moved[WIDTH];
    long long is_stuck[WIDTH], is_moving[WIDTH];
    tvi_passes one[WIDTH];
    tvi_passes_verdict verdict[WIDTH];
} lanes;

static void start_lanes(lanes *w, double slowest)
{
    memset(w, 0, sizeof *w);
    for (int m = 0; m < WIDTH; m++) {
        tvi_passes_begin(&w->one[m], slowest);
        w->slowest[m] = slowest;
        w->size[m] = w->before[m] = INFINITY;
        w->moved[m] = 1;
        w->is_moving[m] = -1;
    }
}

/* A pass of all by both: whether they agree. An asked number of passes shows nothing. */
static bool judge_both(lanes *w, const galerkin_batch_loops *loops, const tvi_passes_rule *rule, int pass,
                       uint64_t *bits)
{
    const galerkin_batch_nodes nodes = {.width = WIDTH, .is_moving = w->is_moving};
    const galerkin_batch_passes passes = {.size = w->size,
                                          .before = w->before,
                                          .part = w->part,
                                          .slowest = w->slowest,
                                          .shown = w->shown,
                                          .count = w->count,
                                          .is_stuck = w->is_stuck};
    bool any_stuck, is_same = true;
    int go_on = 0, stuck = 0;
    for (int m = 0; m < WIDTH; m++) {
        w->moved[m] = next_size(w->moved[m], bits);
        if (!w->is_moving[m]) continue;
        w->verdict[m] = isfinite(w->moved[m]) ? tvi_passes_judge(&w->one[m], rule, w->moved[m]) : TVI_PASSES_STUCK;
        go_on += w->verdict[m] == TVI_PASSES_GO_ON;
        stuck += w->verdict[m] == TVI_PASSES_STUCK;
    }
    is_same &= loops->judge(&nodes, rule, pass, w->moved, &passes, &any_stuck) == go_on;
    for (int m = 0; m < WIDTH; m++) {
        const bool is_stuck = w->verdict[m] == TVI_PASSES_STUCK;
        is_same &= (w->is_moving[m] != 0) == (w->verdict[m] == TVI_PASSES_GO_ON) && (w->is_stuck[m] != 0) == is_stuck;
        is_same &= is_stuck || (w->size[m] == w->one[m].size && (int)w->count[m] == w->one[m].count);
        is_same &= is_stuck || rule->exactly > 0 || w->slowest[m] == w->one[m].slowest;
    }
    return is_same && any_stuck == (stuck > 0);
}

/* In every instruction set that the machine has, with and without a tolerance and a number of passes. */
START_TEST(lanes_judge_as_one_member_does)
{
    const jet_isa isa = (jet_isa)(_i / 3);
    if (isa > jet_sweeps_choose()->isa) return;
    tvi_options options = tvi_options_default();
    if (_i % 3 == 1) options.tolerance = 1e-6;
    if (_i % 3 == 2) options.passes = 5;
    const tvi_passes_rule rule = tvi_galerkin_rule(&tvi_galerkin_fixed_point, 64, &options);
    uint64_t bits = 1;
    int ended = 0, stuck = 0;
    bool is_same = true;
    static lanes w;
    for (int k = 0; k < SEQUENCES; k++) {
        start_lanes(&w, k % 2 == 0 ? 0 : number_of(&bits));
        for (int pass = 1; pass <= PASSES; pass++) is_same &= judge_both(&w, loops_of[isa], &rule, pass, &bits);
        for (int m = 0; m < WIDTH; m++) {
            ended += w.verdict[m] == TVI_PASSES_MAY_END;
            stuck += w.verdict[m] == TVI_PASSES_STUCK;
        }
    }
    ck_assert(is_same);
    ck_assert_int_gt(ended, SEQUENCES);
    ck_assert_int_gt(stuck, SEQUENCES / 100); /* both were seen */
}
END_TEST

/* ---- Halves ------------------------------------------------------------------------------------------------------ */

enum { LANES = TVI_GALERKIN_MAX_LANES };

/* What an impulse of 1 at node j makes of an unknown at node i. */
static long double product_of(const galerkin_halves *of, int points, int i, int j)
{
    const int pair = j < points - 1 - j ? j : points - 1 - j, row = i < points - 1 - i ? i : points - 1 - i;
    const long double late = j > pair ? -1 : 1, first = of->is_crossed ? late : 1, second = of->is_crossed ? 1 : late;
    const long double even = of->even[pair * MOST_PAIRS + row] * first + of->shift[pair] * second;
    const long double odd = of->odd[pair * MOST_PAIRS + row] * second + of->slope[row] * first;
    return i > row ? even - odd : even + odd;
}

/* To the last bit: so they are symplectic and symmetric, as the matrix is. */
START_TEST(halves_are_the_matrix)
{
    const int points = 1 + _i / 2;
    const bool is_second_order = _i % 2 == 0;
    galerkin_tables tables;
    galerkin_halves halves;
    galerkin_tables_open(&tables, points, LANES, is_second_order);
    tvi_galerkin_halves_prepare(&halves, &tables.of, is_second_order);
    for (int i = 0; i < points; i++)
        for (int j = 0; j < points; j++)
            ck_assert(product_of(&halves, points, i, j) == (long double)tables.of.matrix[j * LANES + i]);
    galerkin_tables_close(&tables);
}
END_TEST

/* ---- Starts ------------------------------------------------------------------------------------------------------ */

enum { POINTS = 8, UNKNOWNS = 3, EIGHT_LANES = 3 };

static const galerkin_loops *const loops_of_one[JET_ISA_COUNT] = {
    [jet_isa_base] = &tvi_galerkin_loops_base[EIGHT_LANES],
#ifdef __x86_64__
    [jet_isa_avx2] = &tvi_galerkin_loops_avx2[EIGHT_LANES],
    [jet_isa_avx512] = &tvi_galerkin_loops_avx512[EIGHT_LANES],
#endif
};

/* Before any force, in two parts, to the last bit: what one part lacks makes Kepler's energy drift. */
START_TEST(nodes_start_as_those_of_one_member)
{
    const jet_isa isa = (jet_isa)_i;
    if (isa > jet_sweeps_choose()->isa) return;
    double state[4][UNKNOWNS][WIDTH], start[UNKNOWNS * WIDTH], high[UNKNOWNS][POINTS][WIDTH],
        low[UNKNOWNS][POINTS][WIDTH];
    double c[POINTS], scale[UNKNOWNS] = {0.1, 0.25, 3}, drifted[UNKNOWNS * WIDTH], drifted_low[UNKNOWNS * WIDTH];
    uint64_t bits = 1;
    for (int j = 0; j < POINTS; j++) c[j] = number_of(&bits);
    for (int u = 0; u < 4 * UNKNOWNS; u++)
        for (int m = 0; m < WIDTH; m++) state[u % 4][u / 4][m] = number_of(&bits) * (u % 2 == 0 ? 1 : 0x1p-54);
    const galerkin_batch_nodes nodes = {.width = WIDTH,
                                        .points = POINTS,
                                        .unknowns = UNKNOWNS,
                                        .stride = POINTS,
                                        .start = start,
                                        .high = high[0][0],
                                        .low = low[0][0],
                                        .scale = scale};
    const tvi_batch_origin origin = {.q = state[0][0], .q_low = state[1][0], .p = state[2][0], .p_low = state[3][0]};
    const galerkin_batch_drift drift = {drifted, drifted_low};
    loops_of[isa]->start_drifting(&nodes, c, &origin, &drift);
    for (int m = 0; m < WIDTH; m++) {
        double of[4][UNKNOWNS], from[UNKNOWNS], both[2][UNKNOWNS][POINTS], its_drift[2][UNKNOWNS];
        for (int u = 0; u < 4 * UNKNOWNS; u++) of[u % 4][u / 4] = state[u % 4][u / 4][m];
        const galerkin_nodes one = {.lanes = POINTS,
                                    .unknowns = UNKNOWNS,
                                    .start = from,
                                    .high = both[0][0],
                                    .base = both[1][0],
                                    .scale = scale};
        const tvi_origin its = {.q = of[0], .q_low = of[1], .p = of[2], .p_low = of[3]};
        loops_of_one[isa]->start_drifting(&one, c, &its, its_drift[0], its_drift[1]);
        for (int u = 0; u < UNKNOWNS; u++)
            for (int j = 0; j < POINTS; j++)
                ck_assert(high[u][j][m] == both[0][u][j] && low[u][j][m] == both[1][u][j] && low[u][j][m] != 0);
    }
}
END_TEST

/* Of short impulses and weights, whose products are exact: so are the sums of both parts. */
START_TEST(nodes_end_as_those_of_one_member)
{
    enum { NUMBERS = UNKNOWNS * WIDTH };
    const jet_isa isa = (jet_isa)_i;
    if (isa > jet_sweeps_choose()->isa) return;
    double impulse[UNKNOWNS][POINTS][WIDTH], of_all[6][NUMBERS], drifted[2][NUMBERS], dq[2][NUMBERS];
    double scale[UNKNOWNS] = {0.1, 0.25, 3};
    galerkin_tables tables;
    uint64_t bits = 1;
    galerkin_tables_open(&tables, POINTS, POINTS, true);
    const galerkin_weights *weights = &tables.of.weights;
    for (int k = 0; k < POINTS * OF_PAIR; k++) weights->pair[k] = (float)weights->pair[k];
    for (int k = 0; k < 2 * 8; k++) weights->halves[k] = (float)weights->halves[k];
    for (int k = 0; k < UNKNOWNS * POINTS; k++)
        for (int m = 0; m < WIDTH; m++) impulse[k / POINTS][k % POINTS][m] = (float)(number_of(&bits) - 0.25);
    for (int k = 0; k < 2 * NUMBERS; k++) drifted[k % 2][k / 2] = number_of(&bits) * (k % 2 ? 0x1p-54 : 1);
    const galerkin_batch_nodes nodes = {.width = WIDTH,
                                        .points = POINTS,
                                        .unknowns = UNKNOWNS,
                                        .stride = POINTS,
                                        .impulse = impulse[0][0],
                                        .scale = scale};
    const galerkin_sums sums = {of_all[0], of_all[1], of_all[2], of_all[3], of_all[4], of_all[5]};
    const galerkin_batch_drift drift = {drifted[0], drifted[1]};
    loops_of[isa]->integrate(&nodes, weights, &sums);
    loops_of[isa]->end_drifting(&nodes, &sums, &drift, dq[0], dq[1]);
    for (int m = 0; m < WIDTH; m++) {
        _Alignas(64) double its_impulse[UNKNOWNS * POINTS];
        double its[6][UNKNOWNS + 7], its_drift[2][UNKNOWNS], by[4][UNKNOWNS];
        const galerkin_nodes one = {.lanes = POINTS, .unknowns = UNKNOWNS, .impulse = its_impulse, .scale = scale};
        const galerkin_sums its_sums = {its[0], its[1], its[2], its[3], its[4], its[5]};
        for (int k = 0; k < UNKNOWNS * POINTS; k++) its_impulse[k] = impulse[k / POINTS][k % POINTS][m];
        for (int k = 0; k < 2 * UNKNOWNS; k++) its_drift[k % 2][k / 2] = drifted[k % 2][k / 2 * WIDTH + m];
        loops_of_one[isa]->integrate(&one, weights, &its_sums);
        loops_of_one[isa]->end_drifting(&one, &its_sums, its_drift[0], its_drift[1],
                                        &(tvi_increments){by[0], by[1], by[2], by[3]});
        for (int u = 0; u < UNKNOWNS; u++) {
            const int at = u * WIDTH + m;
            const double apart_q = (dq[0][at] - by[0][u]) + (dq[1][at] - by[2][u]);
            const double apart_p = (sums.once[at] - by[1][u]) + (sums.once_low[at] - by[3][u]);
            ck_assert_double_le(fabs(apart_q), 0x1p-100);
            ck_assert_double_le(fabs(apart_p), 0x1p-100);
            ck_assert(dq[1][at] != 0 && sums.once[at] != 0);
        }
    }
    galerkin_tables_close(&tables);
}
END_TEST

/* ---- Small motions ----------------------------------------------------------------------------------------------- */

/* About (1000, -1000), in momenta of no size of their own. */
static jet far_away(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet x = jet_sub(q[0], 1000), y = jet_add(q[1], 1000), mass = jet_add(1, jet_div(jet_sqr(x), 4));
    return jet_add(jet_div(jet_dot(p, p, N), jet_mul(2, mass)), jet_mul(0.5, jet_add(jet_sqr(x), jet_sqr(y))));
}

static void start_small(group *c, int member, int orbit)
{
    const double size = pow(10, -orbit);
    c->t[member] = 0;
    c->q[member] = 1000 + size;
    c->q[c->members + member] = -1000 - size / 2;
    c->p[member] = c->p[c->members + member] = 0;
}

static void run_small(const tvi_system *system, const tvi_options *options, group *c)
{
    tvi_ensemble *ensemble;
    OK(tvi_ensemble_create(&ensemble, system, options, c->members, 1));
    OK(tvi_ensemble_integrate(ensemble, 0.25, 200, c->t, c->q, c->p, c->status, NULL, NULL));
    for (int m = 0; m < c->members; m++) ck_assert_int_eq(c->status[m], TVI_OK);
    tvi_ensemble_free(ensemble);
}

static const method by_themselves[] = {{"galerkin", 16}, {"poincare", 12}};
enum { BY_THEMSELVES = sizeof by_themselves / sizeof *by_themselves, SMALL = 64, SIZES = 13 }; /* whole blocks */

/* Their passes end at a roundoff that is measured, of one member alone, while the others go on. */
START_TEST(small_motions_go_by_themselves)
{
    static group all, one;
    tvi_system *system;
    tvi_options options;
    OK(tvi_system_hamiltonian(&system, N, far_away, NULL));
    OK(tvi_options_named(by_themselves[_i].name, by_themselves[_i].order, &options));
    all.members = SMALL;
    for (int m = 0; m < all.members; m++) start_small(&all, m, m % SIZES);
    run_small(system, &options, &all);
    for (int m = 0; m < all.members; m++) {
        tvi_integrator *integrator;
        one.members = 1;
        start_small(&one, 0, m % SIZES);
        run_small(system, &options, &one);
        expect_same("small", &all, m, &one, 0);
        start_small(&one, 0, m % SIZES);
        OK(tvi_integrator_create(&integrator, system, &options));
        OK(tvi_integrate(integrator, 0.25, 200, one.t, one.q, one.p, NULL, NULL));
        ck_assert_double_le(distance(&all, m, &one, 0), 2e-11); /* 100 units of roundoff at 1000 */
        tvi_integrator_free(integrator);
    }
    tvi_system_free(system);
}
END_TEST

Suite *suite_lanes(void)
{
    Suite *suite = suite_create("lanes");
    TCase *tests = tcase_create("lanes");
    tcase_add_loop_test(tests, lanes_judge_as_one_member_does, 0, 3 * JET_ISA_COUNT);
    tcase_add_loop_test(tests, nodes_start_as_those_of_one_member, 0, JET_ISA_COUNT);
    tcase_add_loop_test(tests, nodes_end_as_those_of_one_member, 0, JET_ISA_COUNT);
    tcase_add_loop_test(tests, small_motions_go_by_themselves, 0, BY_THEMSELVES);
    tcase_add_loop_test(tests, halves_are_the_matrix, 0, 2 * LANES);
    suite_add_tcase(suite, tests);
    return suite;
}
