/* test_sums.c - Tests sums over the nodes of a Galerkin step (galerkin/ends.h), of every instruction set and number of
 * lanes: those that it ends with, its increments, and those that passes move unknowns by. */
#include "loops.h"
#include "problems/galerkin_tables.h"
#include "problems/random.h"
#include "problems/statistics.h"
#include "suites.h"
#include "tvi.h"

#include <float.h>

enum { UNKNOWNS = 7, SUMMED = 10, ROUNDS = 50, MOST = GALERKIN_MAX_LANES };

static int below(int n, uint64_t *bits) { return (int)(number_of(bits) * n); }

/* Few bits, so that products are exact. */
static void shorten(int count, double x[])
{
    for (int i = 0; i < count; i++) x[i] = (float)x[i];
}

/* Impulses of all sizes in pairs that cancel, in any order, but for one that is larger by `left`: their exact sum. */
static double set_impulses(double impulse[], int lanes, bool is_short, uint64_t *bits)
{
    double left = 0;
    for (int j = 0; j < lanes; j++) {
        impulse[j] = ldexp((double)(1 + below(INT32_MAX, bits)), -below(40, bits)) / 3;
        if (is_short) shorten(1, impulse + j);
        if (j % 2 == 0) continue;
        impulse[j] = -impulse[j - 1];
        if (j > 1) continue;
        impulse[0] += ldexp(fabs(impulse[0]), is_short ? -8 : -48) * below(8, bits);
        if (is_short) shorten(1, impulse);
        left = impulse[0] + impulse[1];
    }
    if (lanes == 1) left = impulse[0];
    for (int j = lanes - 1; j > 0; j--) {
        const int other = below(j + 1, bits);
        const double kept = impulse[j];
        impulse[j] = impulse[other];
        impulse[other] = kept;
    }
    return left;
}

/* The sums of both parts are exact where their terms are; the first parts alone have roundoff of themselves. */
static void check_sums(const galerkin_coefficients *a, const double impulse[], double left, bool is_short,
                       const galerkin_sums *sums, int u)
{
    long double twice = 0, last = 0, sizes = 0, sizes_of_last = 0;
    for (int j = 0; j < a->lane_count; j++) {
        const long double of_last = (long double)a->last_term[j] * impulse[j];
        twice += (long double)a->one_minus_c[j] * impulse[j];
        last += of_last;
        sizes += fabs(impulse[j]);
        sizes_of_last += fabsl(of_last);
    }
    const double once_left = (sums->once[u] - left) + sums->once_low[u];
    const long double twice_left = (sums->twice[u] - twice) + sums->twice_low[u];
    ck_assert_double_le(fabs(once_left), (double)sizes * 0x1p-96);
    ck_assert_double_le(fabs((double)twice_left), (double)sizes * (is_short ? 0x1p-60 : DBL_EPSILON));
    ck_assert_double_le(fabs(sums->once_low[u]), fabs(sums->once[u]) * DBL_EPSILON / 2);
    ck_assert_double_le(fabs(sums->twice_low[u]), fabs(sums->twice[u]) * DBL_EPSILON / 2);
    ck_assert_double_eq_tol(sums->last_term[u], (double)fabsl(last), (double)sizes_of_last * 4 * DBL_EPSILON);
    ck_assert_double_eq(sums->ends[u], fabs(impulse[0]) + fabs(impulse[a->lane_count - 1]));
}

START_TEST(sums_are_compensated)
{
    const int isa = _i / LANE_COUNTS;
    const int size = _i % LANE_COUNTS, lanes = lane_counts[size];
    galerkin_tables tables;
    uint64_t bits = 1;
    if (!loops_of(isa, _i % LANE_COUNTS)) return;
    galerkin_tables_open(&tables, lanes, lanes, true);
    for (int j = 0; j < lanes; j++)
        ck_assert_double_eq_tol(tables.of.one_minus_c[j], 1 - tables.of.c[j], DBL_EPSILON / 2);
    shorten(lanes, tables.of.one_minus_c);
    for (int round = 0; round < ROUNDS; round++)
        for (int unknowns = 1; unknowns <= SUMMED; unknowns++) {
            _Alignas(64) double impulse[SUMMED * MOST];
            const bool is_short = round % 2 > 0;
            double left[SUMMED], all[6][SUMMED + 7];
            const galerkin_nodes nodes = {
                .lane_count = lanes, .unknown_count = unknowns, .node_count = lanes, .impulse = impulse};
            const galerkin_sums sums = {all[0], all[1], all[2], all[3], all[4], all[5]};
            const galerkin_sum_weights weights = {tables.of.one_minus_c, tables.of.last_term};
            for (int u = 0; u < unknowns; u++) left[u] = set_impulses(impulse + u * lanes, lanes, is_short, &bits);
            loops_of(isa, size)->sum_impulses(&nodes, &weights, &sums);
            for (int u = 0; u < unknowns; u++) check_sums(&tables.of, impulse + u * lanes, left[u], is_short, &sums, u);
        }
    galerkin_tables_close(&tables);
}
END_TEST

/* Drift and rise of like size, and what each of them lacks. */
START_TEST(increments_have_two_parts)
{
    const int isa = _i / LANE_COUNTS;
    double of[6][UNKNOWNS], by[4][UNKNOWNS];
    double *drift = of[0], *drift_low = of[1], *twice = of[2], *twice_low = of[3], *scale = of[4], *once = of[5];
    const galerkin_nodes nodes = {
        .lane_count = lane_counts[_i % LANE_COUNTS], .unknown_count = UNKNOWNS, .scale = scale};
    const galerkin_sums sums = {.once = once, .twice = twice, .once_low = drift_low, .twice_low = twice_low};
    const tvi_increments to = {by[0], by[1], by[2], by[3]};
    uint64_t bits = 1;
    if (!loops_of(isa, _i % LANE_COUNTS)) return;
    for (int round = 0; round < ROUNDS; round++) {
        for (int k = 0; k < 6 * UNKNOWNS; k++)
            of[k / UNKNOWNS][k % UNKNOWNS] =
                (number_of(&bits) - 0.5) * (k / UNKNOWNS % 2 && k < 4 * UNKNOWNS ? 0x1p-54 : 1);
        loops_of(isa, _i % LANE_COUNTS)->set_separable_increments(&nodes, &sums, drift, drift_low, &to);
        for (int u = 0; u < UNKNOWNS; u++) {
            const double rise = scale[u] * twice[u], rise_low = fma(scale[u], twice[u], -rise);
            const long double lacks = drift_low[u] + (rise_low + (long double)scale[u] * twice_low[u]);
            const long double left = ((long double)to.dq[u] - drift[u]) - rise;
            ck_assert_double_le(fabs((double)(left + to.dq_low[u] - lacks)), 0x1p-104);
            ck_assert(to.dp[u] == once[u] && to.dp_low[u] == drift_low[u]);
        }
    }
}
END_TEST

/* ---- Tables ------------------------------------------------------------------------------------------------------ */

/* The conditions of symplecticity and of symmetry hold for the numbers themselves, with any number of nodes. */
START_TEST(coefficients_are_symplectic)
{
    const int m = 1 + _i / 2, lanes = m <= 4 ? 4 : m <= 8 ? 8 : MOST;
    const bool is_second_order = _i % 2 == 1;
    galerkin_tables tables;
    galerkin_tables_open(&tables, m, lanes, is_second_order);
    const double *nu = tables.of.nu, *c = tables.of.c, *b = tables.of.b;
    double sum = 0;
    for (int i = 0; i < m; i++) {
        sum += b[i];
        ck_assert(c[i] + c[m - 1 - i] == 1 && b[i] == b[m - 1 - i]);
        for (int j = 0; j < m; j++) {
            const double ij = nu[j * lanes + i], ji = nu[i * lanes + j];
            ck_assert(is_second_order ? ij - ji == c[i] - c[j] : ij + ji == 1);
            ck_assert(ij == nu[(m - 1 - i) * lanes + m - 1 - j]);
        }
    }
    ck_assert(sum == 1);
    galerkin_tables_close(&tables);
}
END_TEST

/* ---- Where passes move unknowns to ------------------------------------------------------------------------------- */

enum { PASSES = 40000 };

typedef struct {
    double high[UNKNOWNS * MOST], base[UNKNOWNS * MOST], x[UNKNOWNS * MOST], impulse[UNKNOWNS * MOST];
    double force[UNKNOWNS * MOST], weight[MOST], start[UNKNOWNS], scale[UNKNOWNS], inverse_size[UNKNOWNS];
} blocks;

/* Adds the errors of the places, in units of roundoff. */
static void add_errors(const galerkin_coefficients *a, const galerkin_nodes *nodes, const double *force, sample *errors)
{
    for (int u = 0; u < nodes->unknown_count; u++)
        for (int i = 0; i < a->node_count; i++) {
            const int at = u * a->lane_count + i;
            long double of_impulses = 0;
            for (int j = 0; j < a->node_count; j++)
                of_impulses +=
                    (long double)a->nu[j * a->lane_count + i] * (nodes->hb[j] * force[u * a->lane_count + j]);
            const long double way = nodes->free_motion_low[at] + nodes->scale[u] * of_impulses;
            sample_add(errors, (double)((nodes->x[at] - nodes->free_motion[at]) - way) / DBL_EPSILON);
        }
}

/* The errors of places from 1/4 to 1, in units of roundoff, where steps have this scale. */
static sample errors_of(const galerkin_coefficients *a, const galerkin_loops *with, int unknowns, double scale)
{
    static blocks w;
    static const int slot[UNKNOWNS] = {0, 1, 2, 3, 4, 5, 6};
    const galerkin_nodes nodes = {.lane_count = a->lane_count,
                                  .node_count = a->node_count,
                                  .unknown_count = unknowns,
                                  .n = unknowns,
                                  .moving_count = unknowns,
                                  .x = w.x,
                                  .start = w.start,
                                  .free_motion = w.high,
                                  .free_motion_low = w.base,
                                  .hb = w.weight,
                                  .impulse = w.impulse,
                                  .scale = w.scale,
                                  .inverse_size = w.inverse_size,
                                  .nu = a->nu};
    uint64_t bits = 1;
    sample errors = {0};
    for (int u = 0; u < unknowns; u++) w.scale[u] = scale, w.inverse_size[u] = 1;
    for (int j = 0; j < a->lane_count; j++) w.weight[j] = scale * a->b[j];
    for (int pass = 0; pass < PASSES; pass++) {
        for (int k = 0; k < unknowns * a->lane_count; k++) {
            w.high[k] = (1 + number_of(&bits) / 8) / 4;
            w.base[k] = (number_of(&bits) - 0.5) * DBL_EPSILON;
            w.force[k] = 12 + number_of(&bits);
        }
        (void)with->move(&nodes, w.force, slot, NULL);
        add_errors(a, &nodes, w.force, &errors);
    }
    return errors;
}

/* With a step near a ratio of small numbers what moves an unknown is close to the middle between two numbers again and
 * again, and always on the same side of it, unless it is added to what has bits of all kinds before it is rounded: the
 * energy drifts. The control is the base set, which has no fused operations and rounds products first. Its ratio is 17
 * for the 320,000 places of four nodes and 14 for the 2,240,000 places of eight. */
START_TEST(places_are_rounded_to_no_side)
{
    static const int unknowns[] = {2, UNKNOWNS};
    const int isa = _i / LANE_COUNTS;
    const int size = _i % LANE_COUNTS, lanes = lane_counts[size];
    galerkin_tables tables;
    if (!loops_of(isa, _i % LANE_COUNTS)) return;
    galerkin_tables_open(&tables, lanes, lanes, true);
    for (size_t k = 0; k < sizeof unknowns / sizeof *unknowns; k++) {
        const sample errors = errors_of(&tables.of, loops_of(isa, size), unknowns[k], 1 / 3.0);
        if (isa != jet_isa_base) ck_assert_double_lt(sample_drift(&errors), NO_DRIFT);
        else if (isa == jet_isa_base && (lanes == 4 || (lanes == 8 && unknowns[k] == UNKNOWNS)))
            ck_assert_double_gt(sample_drift(&errors), NO_DRIFT);
    }
    galerkin_tables_close(&tables);
}
END_TEST

Suite *suite_sums(void)
{
    Suite *suite = suite_create("sums");
    TCase *sums = tcase_create("sums");
    tcase_add_loop_test(sums, sums_are_compensated, 0, JET_ISA_COUNT * LANE_COUNTS);
    tcase_add_loop_test(sums, increments_have_two_parts, 0, JET_ISA_COUNT * LANE_COUNTS);
    tcase_add_loop_test(sums, coefficients_are_symplectic, 0, 2 * TVI_MAX_NODES);
    tcase_add_loop_test(sums, places_are_rounded_to_no_side, 0, JET_ISA_COUNT * LANE_COUNTS);
    suite_add_tcase(suite, sums);
    suite_add_tcase(suite, tcase_chains());
    return suite;
}
