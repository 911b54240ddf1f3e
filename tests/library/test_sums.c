/* test_sums.c - the sums over the nodes that a Galerkin step ends with (loops.h), of every instruction set, number of
 * lanes and way to add: in chains, and of few unknowns at eight nodes as a tree. */
#include "galerkin/coefficients.h"
#include "suites.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

enum { UNKNOWNS = 7, ROUNDS = 50, MOST = TVI_GALERKIN_MAX_LANES };

static const int lanes_of[GALERKIN_LOOPS] = {1, 2, 4, 8, MOST};
static const galerkin_loops *const loops_of[JET_ISA_COUNT] = {
    [jet_isa_base] = tvi_galerkin_loops_base,
#ifdef __x86_64__
    [jet_isa_avx2] = tvi_galerkin_loops_avx2,
    [jet_isa_avx512] = tvi_galerkin_loops_avx512,
#endif
};

typedef struct {
    galerkin_coefficients of;
    galerkin_dense dense;
} tables;

static void take_tables(tables *all, tvi_arena *arena, int lanes)
{
    tvi_galerkin_dense_take(&all->dense, arena, lanes, lanes, jet_sweeps_choose());
    tvi_galerkin_coefficients_take(&all->of, arena, lanes, lanes);
}

static int below(int n, uint64_t *bits)
{
    *bits = *bits * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (int)((*bits >> 33) % (uint64_t)n);
}

/* Impulses of all sizes in pairs that cancel, in any order, but for one that is larger by `left`: their exact sum. */
static double set_impulses(double impulse[], int lanes, uint64_t *bits)
{
    double left = 0;
    for (int j = 0; j < lanes; j++) {
        impulse[j] = ldexp((double)(1 + below(INT32_MAX, bits)), -below(40, bits)) / 3;
        if (j % 2 == 0) continue;
        impulse[j] = -impulse[j - 1];
        if (j > 1) continue;
        impulse[0] += ldexp(fabs(impulse[0]), -48) * below(8, bits);
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

/* The sum of the impulses has roundoff of itself; all others have roundoff of their terms. */
static void check_sums(const galerkin_coefficients *a, const double impulse[], double left, const galerkin_sums *sums,
                       int u)
{
    long double twice = 0, last = 0, sizes = 0, sizes_of_last = 0;
    for (int j = 0; j < a->lanes; j++) {
        const long double of_last = (long double)a->weights.last[j] * impulse[j];
        twice += (1 - (long double)a->c[j]) * impulse[j];
        last += of_last;
        sizes += fabs(impulse[j]);
        sizes_of_last += fabsl(of_last);
    }
    ck_assert_double_eq_tol(sums->once[u], left, (double)sizes * 0x1p-96 + fabs(left) * DBL_EPSILON);
    ck_assert_double_eq_tol(sums->twice[u], (double)twice, (double)sizes * DBL_EPSILON);
    ck_assert_double_eq_tol(sums->last[u], (double)fabsl(last), (double)sizes_of_last * 4 * DBL_EPSILON);
    ck_assert_double_eq(sums->reach[u], fabs(impulse[0]) + fabs(impulse[a->lanes - 1]));
}

START_TEST(sums_are_compensated)
{
    const jet_isa isa = (jet_isa)(_i / GALERKIN_LOOPS);
    const int size = _i % GALERKIN_LOOPS, lanes = lanes_of[size];
    tvi_arena arena = {0};
    tables all = {0};
    uint64_t bits = 1;
    if (isa > jet_sweeps_choose()->isa) return;
    take_tables(&all, &arena, lanes);
    void *memory = tvi_arena_open(&arena);
    ck_assert_ptr_nonnull(memory);
    take_tables(&all, &arena, lanes);
    tvi_galerkin_coefficients_prepare(&all.of, &all.dense, true);
    for (int round = 0; round < ROUNDS; round++)
        for (int unknowns = 1; unknowns <= UNKNOWNS; unknowns++) {
            _Alignas(64) double impulse[UNKNOWNS * MOST];
            double left[UNKNOWNS], once[UNKNOWNS], twice[UNKNOWNS], last[UNKNOWNS], reach[UNKNOWNS];
            const galerkin_nodes nodes = {.lanes = lanes, .unknowns = unknowns, .impulse = impulse};
            const galerkin_sums sums = {once, twice, last, reach};
            for (int u = 0; u < unknowns; u++) left[u] = set_impulses(impulse + u * lanes, lanes, &bits);
            loops_of[isa][size].integrate(&nodes, &all.of.weights, &sums);
            for (int u = 0; u < unknowns; u++) check_sums(&all.of, impulse + u * lanes, left[u], &sums, u);
        }
    free(memory);
}
END_TEST

Suite *suite_sums(void)
{
    Suite *suite = suite_create("sums");
    TCase *sums = tcase_create("sums");
    tcase_add_loop_test(sums, sums_are_compensated, 0, JET_ISA_COUNT * GALERKIN_LOOPS);
    suite_add_tcase(suite, sums);
    return suite;
}
