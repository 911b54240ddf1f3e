/* gauss_lanes.h - Runs Gauss collocation with its nodes as LANES lanes of a vector: included once for each number of
 * LANES.
 *
 * With the accelerations a_j of the nodes,
 *   Q_i = q0 + (h c_i v0 + sum_j h^2 (A^2)_ij a_j),  q1 = q0 + h v0 + h^2 sum b_j (1 - c_j) a_j,  v1 = v0 + h sum b_j
 *   a_j.
 * Arrays are [n][LANES], node by node; a lane without a node repeats the last one. */
#include "force_kernels.h"

#define NAME KERNEL

typedef struct {
    _Alignas(64) double node[LANES];      /* h c_i */
    double matrix[LANES][LANES];          /* [j][i] h^2 (A^2)_ij */
    double extrapolation[LANES][LANES];   /* [j][i] l_j(1 + c_i) */
    double high[2][LANES], low[2][LANES]; /* h b_j, then h^2 b_j (1 - c_j), in two parts */
} NAME(weights);

static void NAME(split)(long double x, double *high, double *low)
{
    *high = (double)x;
    *low = (double)(x - *high);
}

static void NAME(scale_weights)(const gauss_tableau *t, double h, NAME(weights) *w)
{
    const long double H = h;
    *w = (NAME(weights)){0};
    FOR_EACH_LANE(l, LANES) {
        const int i = l < t->s ? l : t->s - 1;
        w->node[l] = (double)(H * t->node[i]);
        for (int j = 0; j < t->s; j++) {
            w->matrix[j][l] = (double)(H * H * t->matrix[i][j]);
            w->extrapolation[j][l] = (double)t->extrapolation[i][j];
        }
    }
    for (int j = 0; j < t->s; j++) {
        NAME(split)(H * t->weight[j], &w->high[0][j], &w->low[0][j]);
        NAME(split)(H * H * t->position_weight[j], &w->high[1][j], &w->low[1][j]);
    }
}

/* sum_j w_j a_j of one coordinate, for one lane. Two sums, as one would wait for each of its terms. */
static INLINE double NAME(row)(int s, const double (*restrict w)[LANES], const double *restrict a, int l)
{
    double even = w[0][l] * a[0], odd = s > 1 ? w[1][l] * a[1] : 0;
    for (int j = 2; j < s; j += 2) even += w[j][l] * a[j];
    for (int j = 3; j < s; j += 2) odd += w[j][l] * a[j];
    return even + odd;
}

/* out = polynomial through a, at the nodes of the next step. */
static INLINE void NAME(extrapolate)(int n, int s, const NAME(weights) *w, const double *restrict a,
                                     double *restrict out)
{
    for (int k = 0; k < n; k++)
        FOR_EACH_LANE(l, LANES) out[k * LANES + l] = NAME(row)(s, w->extrapolation, a + k * LANES, l);
}

/* Q from a; returns how far it moved, summed over all, so that a NaN shows. */
static INLINE double NAME(place)(int n, int s, const NAME(weights) *w, const state *x, const double *restrict a,
                                 double *restrict Q)
{
    double moved[LANES] = {0}, sum = 0;
    for (int k = 0; k < n; k++)
        FOR_EACH_LANE(l, LANES) {
            const double offset = w->node[l] * x->v[k] + NAME(row)(s, w->matrix, a + k * LANES, l);
            const double now = x->q[k] + offset;
            moved[l] += fabs(now - Q[k * LANES + l]);
            Q[k * LANES + l] = now;
        }
    FOR_EACH_LANE(l, LANES) sum += moved[l];
    return sum;
}

/* sum_j w_j a_j with the weights in two parts. */
static INLINE double NAME(integral)(int s, const double *high, const double *low, const double *a)
{
    double sum = 0, rest = 0;
    for (int j = 0; j < s; j++) {
        sum += high[j] * a[j];
        rest += low[j] * a[j];
    }
    return sum + rest;
}

static INLINE void NAME(advance)(int n, int s, const NAME(weights) *w, double h, const double *a, state *x)
{
    for (int k = 0; k < n; k++) {
        const double dv = NAME(integral)(s, w->high[0], w->low[0], a + k * LANES);
        const double dq = NAME(integral)(s, w->high[1], w->low[1], a + k * LANES);
        add(&x->q[k], &x->q_low[k], dq + h * x->v_low[k] + h * x->v[k]);
        add(&x->v[k], &x->v_low[k], dv);
    }
}

typedef void NAME(force)(const double *restrict q, double *restrict a);

/* Fixed-point passes until Q moves no less than at the pass before, at roundoff. Returns their number, 0 = no
 * convergence. */
static INLINE int NAME(iterate)(int n, int s, NAME(force) *force, const NAME(weights) *w, const state *x,
                                double *restrict a, double *restrict Q)
{
    double moved = INFINITY, size = 0;
    for (int k = 0; k < n; k++) size += fabs(x->q[k]);
    for (int pass = 1; pass <= MOST_PASSES; pass++) {
        force(Q, a);
        const double now = NAME(place)(n, s, w, x, a, Q);
        if (now == 0 || (now >= moved && now < ROUNDOFF * size)) return pass;
        if (!(now < INFINITY)) return 0;
        moved = now;
    }
    return 0;
}

static INLINE tvi_status NAME(gauss)(int n, int s, NAME(force) *force, const baseline_task *task, double q[],
                                     double p[], baseline_counts *counts)
{
    _Alignas(64) double a[BASELINE_N_MAX * LANES], Q[BASELINE_N_MAX * LANES], guess[BASELINE_N_MAX * LANES];
    NAME(weights) w;
    state x;
    NAME(scale_weights)(gauss_tableau_of(s), task->h, &w);
    state_start(&x, task, q, p);
    for (int k = 0; k < n; k++)
        FOR_EACH_LANE(l, LANES) Q[k * LANES + l] = x.q[k];
    force(Q, guess);
    for (long step = 1; step <= task->steps; step++) {
        if (step > 1) NAME(extrapolate)(n, s, &w, a, guess);
        NAME(place)(n, s, &w, &x, guess, Q);
        const int passes = NAME(iterate)(n, s, force, &w, &x, a, Q);
        if (passes == 0) return TVI_ENOCONV;
        counts->passes += passes;
        NAME(advance)(n, s, &w, task->h, a, &x);
        if (!observed(&x, task, step)) return TVI_ESTOPPED;
    }
    counts->steps = task->steps;
    counts->force_evaluations = counts->passes * s;
    return state_end(&x, task, q, p);
}

#undef NAME
