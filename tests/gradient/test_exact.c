/* test_exact.c - Compares gradients with eighth-order differences of the same steps in long double: Gauss collocation
 * of 8 nodes, written here from its definition, of a system of each kind and its parameters. */
#include "gradient.h"

#include "tvi_gradient.h"

#include <math.h>
#include <string.h>

enum { NODES = 8, MOST = 4, MOST_C = 3, STEPS = 200 };
typedef long double real;

/* x' = f(x, t, c), x = (q, p). */
typedef void rates(const real x[], real t, const real c[], real f[]);

static void kepler(const real x[], real t, const real c[], real f[])
{
    const real r = sqrtl(x[0] * x[0] + x[1] * x[1]);
    (void)t;
    for (int i = 0; i < 2; i++) f[i] = x[2 + i], f[2 + i] = -c[0] * x[i] / (r * r * r);
}

static void magnetic(const real x[], real t, const real c[], real f[])
{
    const real bent = c[0] * (0.5L + x[0] * x[0] / 8), slope = c[0] * x[0] / 4, r2 = x[0] * x[0] + x[1] * x[1];
    const real v0 = x[2] + bent * x[1], v1 = x[3] - bent * x[0], spring = 1 + r2 / 2;
    (void)t;
    f[0] = v0, f[1] = v1;
    f[2] = -(v0 * slope * x[1] - v1 * (slope * x[0] + bent) + spring * x[0]);
    f[3] = -(v0 * bent + spring * x[1]);
}

static void driven(const real x[], real t, const real c[], real f[])
{
    f[0] = x[1];
    f[1] = -c[0] * sinl(x[0]) - c[1] * x[1] + c[2] * cosl(0.6L * t);
}

/* The momenta are those of L = (1 + m) v0^2/2 + m v1^2/2 + m v0 v1 cos(q0 - q1) + g ((1 + m) cos q0 + m cos q1). */
static void double_pendulum(const real x[], real t, const real c[], real f[])
{
    const real g = c[0], m = c[1], k = m * cosl(x[0] - x[1]), s = m * sinl(x[0] - x[1]);
    const real determinant = (1 + m) * m - k * k;
    (void)t;
    f[0] = (m * x[2] - k * x[3]) / determinant;
    f[1] = ((1 + m) * x[3] - k * x[2]) / determinant;
    f[2] = -s * f[0] * f[1] - g * (1 + m) * sinl(x[0]);
    f[3] = s * f[0] * f[1] - g * m * sinl(x[1]);
}

static const struct {
    int problem, n, parameters;
    rates *f;
    double c[MOST_C];
} systems[] = {{COLUMNS_KEPLER, 2, 1, kepler, {1}},
               {COLUMNS_MAGNETIC, 2, 1, magnetic, {0.7}},
               {COLUMNS_DRIVEN, 1, 3, driven, {1, 0.05, 0.3}},
               {GRADIENT_DOUBLE_PENDULUM, 2, 2, double_pendulum, {9.8, 1}}};
enum { SYSTEMS = sizeof systems / sizeof *systems };

/* ---- The method -------------------------------------------------------------------------------------------------- */

static real c_of[NODES], b_of[NODES], a_of[NODES][NODES];

/* l_j at s. */
static real lagrange(int j, real s)
{
    real product = 1;
    for (int k = 0; k < NODES; k++)
        if (k != j) product *= (s - c_of[k]) / (c_of[j] - c_of[k]);
    return product;
}

static void set_method(void)
{
    for (int i = 0; i < NODES; i++) {
        real x = cosl(acosl(-1) * (i + 0.75L) / (NODES + 0.5L)), slope = 1;
        for (int round = 0; round < 50; round++) {
            real before = 1, now = x;
            for (int k = 2; k <= NODES; k++) {
                const real next = ((2 * k - 1) * x * now - (k - 1) * before) / k;
                before = now, now = next;
            }
            slope = NODES * (before - x * now) / (1 - x * x);
            x -= now / slope;
        }
        c_of[NODES - 1 - i] = (1 + x) / 2;
        b_of[NODES - 1 - i] = 1 / ((1 - x * x) * slope * slope);
    }
    for (int i = 0; i < NODES; i++)
        for (int j = 0; j < NODES; j++) {
            a_of[i][j] = 0;
            for (int k = 0; k < NODES; k++) a_of[i][j] += c_of[i] * b_of[k] * lagrange(j, c_of[i] * c_of[k]);
        }
}

/* Makes a step: passes until nothing changes, or 200. */
static void make_step(rates *f, int size, real h, real t, const real c[], real x[], real k[NODES][MOST])
{
    real change = 1;
    for (int pass = 0; pass < 200 && change > 0x1p-66L; pass++) {
        change = 0;
        for (int i = 0; i < NODES; i++) {
            real at[MOST], rate[MOST];
            for (int d = 0; d < size; d++) {
                at[d] = x[d];
                for (int j = 0; j < NODES; j++) at[d] += h * a_of[i][j] * k[j][d];
            }
            f(at, t + c_of[i] * h, c, rate);
            for (int d = 0; d < size; d++) {
                change = fmaxl(change, fabsl(rate[d] - k[i][d]));
                k[i][d] = rate[d];
            }
        }
    }
    for (int d = 0; d < size; d++)
        for (int i = 0; i < NODES; i++) x[d] += h * b_of[i] * k[i][d];
}

/* A run of one of the systems from z, which is x and then c, of which number i moves. */
typedef struct {
    int which, i;
    const real *z;
    real h;
    const double *a;
} moved_run;

/* a.x after STEPS steps. */
static real loss_at_end(real d, void *ctx)
{
    const moved_run *run = ctx;
    const int size = 2 * systems[run->which].n;
    real x[MOST], z[MOST + MOST_C], k[NODES][MOST] = {{0}}, loss = 0;
    memcpy(z, run->z, sizeof z);
    z[run->i] += d;
    memcpy(x, z, (size_t)size * sizeof *x);
    for (int step = 0; step < STEPS; step++)
        make_step(systems[run->which].f, size, run->h, step * run->h, z + size, x, k);
    for (int i = 0; i < size; i++) loss += run->a[i] * x[i];
    return loss;
}

START_TEST(long_double)
{
    const int n = systems[_i].n, size = 2 * n, parameters = systems[_i].parameters;
    columns_run run;
    const double a[] = {1, -0.7, 0.4, 1.3, 0};
    double by_start[2 * MOST + 1], by[MOST + MOST_C], largest = 0;
    real z[MOST + MOST_C] = {0};
    gradient_open(&run, systems[_i].problem, NULL, 0);
    set_method();
    for (int i = 0; i < n; i++) z[i] = run.q[i], z[n + i] = run.p[i];
    for (int i = 0; i < parameters; i++) z[size + i] = systems[_i].c[i];
    const tvi_run_plan plan = {.h = run.problem->h, .steps = STEPS, .record = run.record};
    ck_assert_int_eq(tvi_run(run.it, &plan, &run.t, run.q, run.p), TVI_OK);
    double end[MOST + 1] = {0};
    memcpy(end, a, (size_t)size * sizeof *a);
    ck_assert_int_eq(tvi_gradient(run.record, &(tvi_loss){.end = end}, by_start, by + size), TVI_OK);
    memcpy(by, by_start, (size_t)size * sizeof *by);
    for (int i = 0; i < size + parameters; i++) largest = fmax(largest, fabs(by[i]));
    for (int i = 0; i < size + parameters; i++) {
        moved_run moved = {_i, i, z, run.problem->h, a};
        const real slope = gradient_slope(loss_at_end, &moved, 1e-4L);
        ck_assert_msg(fabs(by[i] - (double)slope) <= 1e-12 * largest, "%s, %d: %.16g and %.16Lg, of %g",
                      run.problem->name, i, by[i], slope, largest);
    }
    columns_close(&run);
}
END_TEST

TCase *tcase_exact(void)
{
    TCase *c = tcase_create("exact");
    tcase_add_loop_test(c, long_double, 0, SYSTEMS);
    return c;
}
