/* rattle.c - Runs RATTLE and its symmetric compositions by hand. */
#include "hand.h"

#include "baselines/state.h"

enum { STAGES_MOST = 35, CORRECTIONS_MOST = 50 };

/* ---- Compositions ------------------------------------------------------------------------------------------------ */

/* Of symmetric steps of order 2, by the first weights g_i up to the middle one. Kahan and Li, Composition constants for
 * raising the orders of unconventional schemes, Math. Comp. 66 (1997); Hairer, Lubich and Wanner, Geometric Numerical
 * Integration, V.3.2. Order 4 is Suzuki's. */
typedef struct {
    int order, stages;
    double g[STAGES_MOST / 2 + 1];
} composition;

static const composition compositions[] = {
    {2, 1, {1}},
    {4, 5, {0.41449077179437573714, 0.41449077179437573714, -0.65796308717750294857}},
    {6,
     9,
     {0.39216144400731413927925056, 0.33259913678935943859974864, -0.70624617255763935980996482,
      0.08221359629355080023149045, 0.79854399093482996339895035}},
    {8,
     17,
     {0.13020248308889008087881763, 0.56116298177510838456196441, -0.38947496264484728640807860,
      0.15884190655515560089621075, -0.39590389413323757733623154, 0.18453964097831570709183254,
      0.25837438768632204729397911, 0.29501172360931029887096624, -0.60550853383003451169892108}},
    {10,
     35,
     {0.07879572252168641926390768, 0.31309610341510852776481247, 0.02791838323507806610952027,
      -0.22959284159390709415121340, 0.13096206107716486317465686, -0.26973340565451071434460973,
      0.07497334315589143566613711, 0.11199342399981020488957508, 0.36613344954622675119314812,
      -0.39910563013603589787862981, 0.10308739852747107731580277, 0.41143087395589023782070412,
      -0.00486636058313526176219566, -0.39203335370863990644808194, 0.05194250296244964703718290,
      0.05066509075992449633587434, 0.04967437063772987905456880, 0.04931773575959453791768001}},
};

/* h g_i, with a sum of h. */
static int set_stages(int order, double h, double stage[])
{
    const composition *c = compositions;
    while (c->order != order) c++;
    long double left = 1;
    for (int i = 0; i < c->stages / 2; i++) {
        stage[i] = stage[c->stages - 1 - i] = h * c->g[i];
        left -= 2 * (long double)c->g[i];
    }
    stage[c->stages / 2] = (double)(h * left);
    return c->stages;
}

/* ---- Stages ------------------------------------------------------------------------------------------------------ */

/* Velocities are those between the stages: what they have along G^T is part of the next impulse. g is that of q. */
typedef struct {
    double q[WORK_NUMBERS], v[WORK_NUMBERS], q_low[WORK_NUMBERS], v_low[WORK_NUMBERS], g[WORK_NUMBERS];
} place;

/* The multipliers of a stage in the last three steps. */
typedef struct {
    double mu[3][MU_MOST];
} history;

static INLINE void guess(int m, long step, const history *of, double mu[])
{
    for (int k = 0; k < m; k++)
        mu[k] = step == 0   ? 0
                : step == 1 ? of->mu[0][k]
                : step == 2 ? 2 * of->mu[0][k] - of->mu[1][k]
                            : 3 * (of->mu[0][k] - of->mu[1][k]) + of->mu[2][k];
}

static INLINE void remember(int m, history *of, const double mu[])
{
    for (int k = 0; k < m; k++) of->mu[2][k] = of->mu[1][k], of->mu[1][k] = of->mu[0][k], of->mu[0][k] = mu[k];
}

/* q1 = q + h (v - W G^T mu) with phi(q1) = 0, by Newton. Its errors are squared: one below 1e-9 of a unit is corrected
 * for the last time. */
static INLINE bool drift(const hand *p, double h, place *x, double mu[])
{
    double impulse[WORK_NUMBERS], q[WORK_NUMBERS], low[WORK_NUMBERS], g[WORK_NUMBERS];
    double r[MU_MOST], by_low[MU_MOST], S[S_MOST] = {0};
    bool is_last = false;
    for (int correction = 0; correction < CORRECTIONS_MOST; correction++) {
        double worst = 0;
        p->apply_WGT(x->g, mu, impulse);
        for (int i = 0; i < p->n; i++) {
            q[i] = x->q[i], low[i] = x->q_low[i];
            add(&q[i], &low[i], h * (x->v[i] - impulse[i]));
        }
        p->evaluate(q, r, g);
        p->apply_G(g, low, by_low);
        for (int k = 0; k < p->m; k++) r[k] += by_low[k], worst = fmax(worst, fabs(r[k]));
        if (!(worst < 1e6 * p->unit)) return false;
        if (is_last || worst == 0) {
            for (int i = 0; i < p->n; i++) add(&x->v[i], &x->v_low[i], -impulse[i]);
            memcpy(x->q, q, sizeof q);
            memcpy(x->q_low, low, sizeof low);
            memcpy(x->g, g, sizeof g);
            return true;
        }
        is_last = worst < 1e-9 * p->unit;
        p->set_S(g, x->g, S);
        hand_factor(p, S);
        hand_solve(p, S, r);
        for (int k = 0; k < p->m; k++) mu[k] += r[k] / h;
    }
    return false;
}

static INLINE void kick(const hand *p, double h, place *x)
{
    double a[WORK_NUMBERS];
    p->accelerate(x->q, a);
    for (int i = 0; i < p->n; i++) add(&x->v[i], &x->v_low[i], h * a[i]);
}

/* v -= W G^T mu with G v = 0. */
static INLINE void project(const hand *p, place *x)
{
    double mu[MU_MOST], impulse[WORK_NUMBERS], S[S_MOST] = {0};
    p->set_S(x->g, x->g, S);
    p->apply_G(x->g, x->v, mu);
    hand_factor(p, S);
    hand_solve(p, S, mu);
    p->apply_WGT(x->g, mu, impulse);
    for (int i = 0; i < p->n; i++) x->v[i] -= impulse[i];
}

/* The kicks of two stages that meet are one. The velocities need to be projected at the end alone: positions do not see
 * it. */
static INLINE bool rattle(const hand *p, const work_task *task, int order, double q[], double v[])
{
    double stage[STAGES_MOST], mu[MU_MOST], phi[MU_MOST];
    history of[STAGES_MOST];
    place x = {0};
    const int stages = set_stages(order, task->duration / (double)task->steps, stage);
    memcpy(x.q, q, (size_t)p->n * sizeof *q);
    memcpy(x.v, v, (size_t)p->n * sizeof *v);
    p->evaluate(x.q, phi, x.g);
    kick(p, stage[0] / 2, &x);
    for (long step = 0; step < task->steps; step++)
        for (int i = 0; i < stages; i++) {
            const bool ends = step + 1 == task->steps && i + 1 == stages;
            guess(p->m, step, &of[i], mu);
            if (!drift(p, stage[i], &x, mu)) return false;
            remember(p->m, &of[i], mu);
            kick(p, (stage[i] + (ends ? 0 : stage[(i + 1) % stages])) / 2, &x);
        }
    project(p, &x);
    memcpy(q, x.q, (size_t)p->n * sizeof *q);
    memcpy(v, x.v, (size_t)p->n * sizeof *v);
    return true;
}

bool rattle_run(const work_task *task, int order, double q[], double v[])
{
    switch (task->problem) {
    case WORK_PENDULUM: return rattle(&hand_pendulum, task, order, q, v);
    case WORK_DOUBLE: return rattle(&hand_double, task, order, q, v);
    case WORK_CHAIN: return rattle(&hand_chain, task, order, q, v);
    case WORK_WATER: return rattle(&hand_water, task, order, q, v);
    case WORK_TOP: return rattle(&hand_top, task, order, q, v);
    case WORK_PROBLEMS: break;
    }
    return false;
}
