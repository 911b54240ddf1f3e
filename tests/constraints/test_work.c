/* test_work.c - Tests what steps take of constraints at one state: the inverse masses, and low-order parts. */
#include "constraints.h"
#include "system/constraint.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void *open_work(tvi_constraint_work *work, const tvi_system *system)
{
    tvi_arena arena = {0};
    *work = (tvi_constraint_work){0};
    tvi_constraint_allocate(work, &arena, system);
    void *memory = tvi_arena_obtain_memory(&arena);
    ck_assert_ptr_nonnull(memory);
    tvi_constraint_allocate(work, &arena, system);
    tvi_system_prepare_blocks(system, arena.first_tape_block, NULL);
    return memory;
}

/* ---- Inverse masses ---------------------------------------------------------------------------------------------- */

/* More coordinates than derivatives that are computed at once. */
enum { MANY = 11 };

/* x^T A(q) x / 2, with A_ii = 2 + i + q_i^2 and A_i,i+1 = cos q_0 / 2. */
static jet square(const jet q[], const jet x[], jet t, void *ctx)
{
    jet term[2 * MANY];
    (void)t, (void)ctx;
    for (int i = 0; i < MANY; i++) {
        term[2 * i] = jet_mul(jet_mul(0.5, jet_add(2 + i, jet_sqr(q[i]))), jet_sqr(x[i]));
        term[2 * i + 1] = i + 1 < MANY ? jet_mul(jet_mul(0.5, jet_cos(q[0])), jet_mul(x[i], x[i + 1])) : jet_const(0);
    }
    return jet_sum(term, 2 * MANY);
}

static double entry(const double q[], int i, int j)
{
    return i == j ? 2 + i + q[i] * q[i] : abs(i - j) == 1 ? cos(q[0]) / 2 : 0;
}

static void plane(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    value[0] = jet_sub(jet_sum(q, MANY), 1);
}

/* H_pp is A, and L_vv^-1 its inverse. */
START_TEST(inverse_masses)
{
    tvi_system *base, *system;
    tvi_constraint_work work;
    double q[MANY], p[MANY];
    ck_assert_int_eq(_i ? tvi_system_lagrangian(&base, MANY, square, NULL)
                        : tvi_system_hamiltonian(&base, MANY, square, NULL),
                     TVI_OK);
    ck_assert_int_eq(tvi_system_constrained(&system, base, 1, plane, NULL), TVI_OK);
    void *memory = open_work(&work, system);
    for (int i = 0; i < MANY; i++) q[i] = 0.1 * i - 0.4, p[i] = 0.7 - 0.05 * i;
    ck_assert_int_eq(tvi_constraint_set_W(&work, 0, q, p), TVI_OK);
    for (int i = 0; i < MANY; i++)
        for (int j = 0; j < MANY; j++) {
            double product = 0;
            for (int k = 0; k < MANY; k++) product += entry(q, i, k) * work.W[k * MANY + j];
            const double is = _i ? product : work.W[i * MANY + j], wanted = _i ? i == j : entry(q, i, j);
            ck_assert_msg(fabs(is - wanted) <= 1e-14 * (1 + fabs(wanted)), "%d %d: %g, not %g", i, j, is, wanted);
        }
    double v[MANY], of_p[MANY];
    ck_assert_int_eq(tvi_constraint_velocity(&work, 0, q, p, v), TVI_OK);
    ck_assert_int_eq(tvi_velocity(base, 0, q, p, of_p), TVI_OK);
    for (int i = 0; i < MANY; i++) ck_assert_double_le(fabs(v[i] - of_p[i]), 1e-15);
    free(memory);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* ---- Low-order parts --------------------------------------------------------------------------------------------- */

/* What is projected is q + q_low and p + p_low of a pendulum: their directions stay, and the sum is on the circle. The
 * second time only p_low is wrong, and all of p is what it should be. */
START_TEST(low_parts)
{
    tvi_system *system = system_of(&problems[PENDULUM]);
    tvi_constraint_work work;
    void *memory = open_work(&work, system);
    double q[] = {0.75, -1}, q_low[] = {_i ? 0 : 1e-10, _i ? 0 : 3e-10}, p[] = {4, 3}, p_low[] = {2e-10, -1e-10};
    const long double x = (long double)q[0] + q_low[0], y = (long double)q[1] + q_low[1], size = sqrtl(x * x + y * y);
    const long double u = (long double)p[0] + p_low[0], w = (long double)p[1] + p_low[1],
                      along = (x * u + y * w) / size;
    ck_assert_int_eq(tvi_constraint_project(&work, 0, q, q_low, p, p_low, true), TVI_OK);
    const long double wanted[] = {ROD[0] * x / size, ROD[0] * y / size, u - along * x / size, w - along * y / size};
    const long double is[] = {(long double)q[0] + q_low[0], (long double)q[1] + q_low[1], (long double)p[0] + p_low[0],
                              (long double)p[1] + p_low[1]};
    for (int i = 0; i < 4; i++)
        ck_assert_msg(fabsl(is[i] - wanted[i]) <= (i < 2 ? 2 : 8) * (long double)DBL_EPSILON, "%d: off by %Lg", i,
                      is[i] - wanted[i]);
    for (int i = 0; i < 2; i++) {
        ck_assert_double_le(fabs(q_low[i]), DBL_EPSILON / 2 * fabs(q[i]));
        ck_assert_double_le(fabs(p_low[i]), DBL_EPSILON / 2 * fabs(p[i]));
    }
    free(memory);
    tvi_system_free(system);
}
END_TEST

Suite *suite_work(void)
{
    Suite *suite = suite_create("work");
    TCase *tests = tcase_create("work");
    tcase_add_loop_test(tests, inverse_masses, 0, 2);
    tcase_add_loop_test(tests, low_parts, 0, 2);
    suite_add_tcase(suite, tests);
    return suite;
}
