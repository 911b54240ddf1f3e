/* double_pendulum.c - Runs Gauss collocation of order 12 for the double pendulum, on Hamilton's equations by hand:
 *   a = (m1 + m2) l1^2,  b = m2 l2^2,  c = m2 l1 l2 cos(q1 - q2),
 *   v = M^-1 p = (b p1 - c p2, a p2 - c p1) / (a b - c^2),  w = m2 l1 l2 v1 v2 sin(q1 - q2),
 *   q' = v,  p1' = -w - (m1 + m2) g l1 sin q1,  p2' = w - m2 g l2 sin q2,
 * solved by fixed point to roundoff from the extrapolated slopes of the step before. */
#include "baseline.h"
#include "gauss_tableau.h"
#include "state.h"

#include <math.h>
#include <string.h>

enum { STAGES = 6, SIZE = 4, MOST_PASSES = 100 };
static const double ROUNDOFF = 1e-13; /* relative: below it, a pass that no longer converges ends the iteration */

#define MASS_1   1.0
#define MASS_2   0.625
#define LENGTH_1 1.0
#define LENGTH_2 0.75
#define GRAVITY  9.8125

/* Slopes f of all nodes: y and f are [SIZE][STAGES], y = (q1, q2, p1, p2). */
static void slopes(double y[SIZE][STAGES], double f[SIZE][STAGES])
{
    const double a = (MASS_1 + MASS_2) * LENGTH_1 * LENGTH_1, b = MASS_2 * LENGTH_2 * LENGTH_2;
    double s[2][STAGES], c[2][STAGES];
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < STAGES; i++) s[k][i] = sin(y[k][i]), c[k][i] = cos(y[k][i]);
    for (int i = 0; i < STAGES; i++) {
        const double cosine = c[0][i] * c[1][i] + s[0][i] * s[1][i], sine = s[0][i] * c[1][i] - c[0][i] * s[1][i];
        const double mixed = MASS_2 * LENGTH_1 * LENGTH_2 * cosine, over = 1 / (a * b - mixed * mixed);
        const double v1 = (b * y[2][i] - mixed * y[3][i]) * over, v2 = (a * y[3][i] - mixed * y[2][i]) * over;
        const double w = MASS_2 * LENGTH_1 * LENGTH_2 * v1 * v2 * sine;
        f[0][i] = v1, f[1][i] = v2;
        f[2][i] = -w - (MASS_1 + MASS_2) * GRAVITY * LENGTH_1 * s[0][i];
        f[3][i] = w - MASS_2 * GRAVITY * LENGTH_2 * s[1][i];
    }
}

typedef struct {
    double matrix[STAGES][STAGES], extrapolation[STAGES][STAGES]; /* [j][i]: h A_ij, l_j(1 + c_i) */
    double high[STAGES], low[STAGES];                             /* h b_j in two parts */
} weights;

static void set_weights(double h, weights *w)
{
    const gauss_tableau *t = gauss_tableau_of(STAGES);
    for (int j = 0; j < STAGES; j++) {
        const long double b = h * t->weight[j];
        w->high[j] = (double)b;
        w->low[j] = (double)(b - w->high[j]);
        for (int i = 0; i < STAGES; i++) {
            w->matrix[j][i] = (double)(h * t->first_order[i][j]);
            w->extrapolation[j][i] = (double)t->extrapolation[i][j];
        }
    }
}

/* out_i = sum_j m[j][i] f_j. */
static void combine(double m[STAGES][STAGES], const double f[STAGES], double out[STAGES])
{
    for (int i = 0; i < STAGES; i++) out[i] = 0;
    for (int j = 0; j < STAGES; j++)
        for (int i = 0; i < STAGES; i++) out[i] += m[j][i] * f[j];
}

/* Y = y + h A f; returns how far it moved. */
static double place(weights *w, const double y[SIZE], double f[SIZE][STAGES], double Y[SIZE][STAGES])
{
    double moved = 0;
    for (int k = 0; k < SIZE; k++) {
        double offset[STAGES];
        combine(w->matrix, f[k], offset);
        for (int i = 0; i < STAGES; i++) {
            const double now = y[k] + offset[i];
            moved += fabs(now - Y[k][i]);
            Y[k][i] = now;
        }
    }
    return moved;
}

/* Passes until Y moves no less than at the pass before, at roundoff; their number, 0 = no convergence. */
static int iterate(weights *w, const double y[SIZE], double f[SIZE][STAGES], double Y[SIZE][STAGES])
{
    double moved = INFINITY, size = 0;
    for (int k = 0; k < SIZE; k++) size += fabs(y[k]);
    for (int pass = 1; pass <= MOST_PASSES; pass++) {
        slopes(Y, f);
        const double now = place(w, y, f, Y);
        if (now == 0 || (now >= moved && now < ROUNDOFF * size)) return pass;
        if (!(now < INFINITY)) return 0;
        moved = now;
    }
    return 0;
}

static void advance(const weights *w, double f[SIZE][STAGES], double y[SIZE], double low[SIZE])
{
    for (int k = 0; k < SIZE; k++) {
        double sum = 0, rest = 0;
        for (int j = 0; j < STAGES; j++) sum += w->high[j] * f[k][j], rest += w->low[j] * f[k][j];
        add(&y[k], &low[k], sum + rest);
    }
}

static tvi_status run(const baseline *self, const baseline_task *task, double q[], double p[], baseline_counts *counts)
{
    double y[SIZE] = {q[0], q[1], p[0], p[1]}, low[SIZE] = {0}, Y[SIZE][STAGES], f[SIZE][STAGES], guess[SIZE][STAGES];
    weights w;
    (void)self;
    *counts = (baseline_counts){0};
    set_weights(task->h, &w);
    for (int k = 0; k < SIZE; k++)
        for (int i = 0; i < STAGES; i++) Y[k][i] = y[k];
    slopes(Y, guess);
    for (long step = 1; step <= task->steps; step++) {
        for (int k = 0; step > 1 && k < SIZE; k++) combine(w.extrapolation, f[k], guess[k]);
        place(&w, y, guess, Y);
        const int passes = iterate(&w, y, f, Y);
        if (passes == 0) return TVI_ENOCONV;
        counts->passes += passes;
        advance(&w, f, y, low);
        if (task->observer && task->observer(step, (double)step * task->h, y, y + 2, task->ctx) != 0)
            return TVI_ESTOPPED;
    }
    counts->steps = task->steps;
    counts->force_evaluations = counts->passes * STAGES;
    memcpy(q, y, 2 * sizeof *q);
    memcpy(p, y + 2, 2 * sizeof *p);
    return TVI_OK;
}

static bool serves(const baseline *self, const scene *s)
{
    (void)self;
    return s == &scene_double_pendulum;
}

const baseline baseline_double_pendulum = {
    .name = "gauss-by-hand", .order = 2 * STAGES, .symplectic = true, .serves = serves, .run = run};
