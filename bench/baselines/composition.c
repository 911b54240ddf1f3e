/* composition.c - Runs compositions of Stormer-Verlet and splittings: drifts q += a_i h v and kicks v += b_i h M^-1
 * F(q) take turns. */
#include "forces.h"
#include "solar_rows.h"
#include "state.h"

#define LANES 1
#include "force_kernels.h"
#undef LANES

enum { STAGES_MAX = 17 };

/* stages force evaluations a step. A composition: the first weights g_i of its symmetric stages, the middle one follows
 * from sum g_i = 1. A splitting that begins and ends with a drift: the first drifts a_i and kicks b_i of a symmetric
 * row, the middle ones follow from sum a_i = sum b_i = 1. */
typedef struct {
    int stages;
    bool drift_first;
    double g[STAGES_MAX / 2], a[STAGES_MAX / 2], b[STAGES_MAX / 2];
} splitting;

static const splitting verlet = {.stages = 1};

/* Kahan and Li, Composition constants for raising the orders of unconventional schemes, Math. Comp. 66 (1997); Hairer,
 * Lubich and Wanner, Geometric Numerical Integration, V.3.2. */
static const splitting kahan_li = {
    .stages = 17,
    .g = {0.13020248308889008087881763, 0.56116298177510838456196441, -0.38947496264484728640807860,
          0.15884190655515560089621075, -0.39590389413323757733623154, 0.18453964097831570709183254,
          0.25837438768632204729397911, 0.29501172360931029887096624},
};

/* Blanes and Moan, Practical symplectic partitioned Runge-Kutta and Runge-Kutta-Nystrom methods, J. Comput. Appl. Math.
 * 142 (2002), SRKN_14^a. It has order 6 for a force that depends on q alone and a kinetic energy that is quadratic. */
static const splitting blanes_moan = {
    .stages = 14,
    .drift_first = true,
    .a = {0.0378593198406116, 0.102635633102435, -0.0258678882665587, 0.314241403071447, -0.130144459517415,
          0.106417700369543, -0.00879424312851058},
    .b = {0.09171915262446165, 0.183983170005006, -0.05653436583288827, 0.004914688774712854, 0.143761127168358,
          0.328567693746804},
};

/* ---- From the table to one step ---------------------------------------------------------------------------------- */

/* The two ends of a step share one operation, and between them the two operations take turns:
 *   outer[0] inner[0] outer[1] ... inner[stages-1] outer[stages]. */
typedef struct {
    double outer[STAGES_MAX + 1], inner[STAGES_MAX], seam; /* times h; seam: outer of two steps that meet */
} schedule;

/* out[0..count-1] = h times the symmetric row of sum 1 that begins with first. */
static void complete(const double first[], int count, double h, double out[])
{
    long double left = 1;
    for (int i = 0; i < count / 2; i++) {
        const bool middle = count % 2 == 0 && i == count / 2 - 1;
        const long double x = middle ? left / 2 : first[i];
        out[i] = out[count - 1 - i] = (double)(h * x);
        left -= 2 * x;
    }
    if (count % 2 == 1) out[count / 2] = (double)(h * left);
}

/* A composition drifts by g_i and kicks by the halves of g_i and g_{i+1}. */
static void schedule_make(const splitting *m, double h, schedule *plan)
{
    const int s = m->stages;
    if (m->drift_first) {
        complete(m->a, s + 1, h, plan->outer);
        complete(m->b, s, h, plan->inner);
    } else {
        complete(m->g, s, h, plan->inner);
        for (int i = 0; i <= s; i++)
            plan->outer[i] = ((i > 0 ? plan->inner[i - 1] : 0) + (i < s ? plan->inner[i] : 0)) / 2;
    }
    plan->seam = plan->outer[0] + plan->outer[s];
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

/* A state in the order that the force wants: as it is, or the rows of solar_rows.h, with copies of two bodies. */
typedef struct {
    _Alignas(64) double q[ROWS], v[ROWS], q_low[ROWS], v_low[ROWS], a[ROWS];
} slots;

static INLINE int coordinate_in(int slot, int n)
{
    return n == ROWS ? 3 * (slot % ROW % 6) + slot / ROW : slot;
}

static INLINE void pack(int n, const state *x, slots *y)
{
    for (int k = 0; k < n; k++) {
        const int i = coordinate_in(k, n);
        y->q[k] = x->q[i], y->v[k] = x->v[i], y->q_low[k] = x->q_low[i], y->v_low[k] = x->v_low[i];
    }
}

static INLINE void unpack(int n, const slots *y, state *x)
{
    for (int k = 0; k < n; k++) {
        const int i = coordinate_in(k, n);
        x->q[i] = y->q[k], x->v[i] = y->v[k], x->q_low[i] = y->q_low[k], x->v_low[i] = y->v_low[k];
    }
}

typedef void force_fn(const double *restrict q, double *restrict a);

static INLINE void kick(int n, double weight, slots *y)
{
    for (int k = 0; k < n; k++) add(&y->v[k], &y->v_low[k], weight * y->a[k]);
}

static INLINE void drift(int n, double weight, slots *y, force_fn *force)
{
    for (int k = 0; k < n; k++) add(&y->q[k], &y->q_low[k], weight * y->v[k]);
    force(y->q, y->a);
}

static INLINE void apply(bool is_drift, int n, double weight, slots *y, force_fn *force)
{
    if (is_drift) drift(n, weight, y, force);
    else kick(n, weight, y);
}

/* The end of a step and the start of the next are one operation, unless an observer looks in between. */
static INLINE tvi_status compose(int n, bool drift_first, force_fn *force, const splitting *m,
                                 const baseline_task *task, double q[], double p[])
{
    const int s = m->stages;
    schedule plan;
    state x;
    slots y;
    schedule_make(m, task->h, &plan);
    state_start(&x, task, q, p);
    pack(n, &x, &y);
    force(y.q, y.a);
    apply(drift_first, n, plan.outer[0], &y, force);
    for (long step = 1; step <= task->steps; step++) {
        for (int i = 0; i < s - 1; i++) {
            apply(!drift_first, n, plan.inner[i], &y, force);
            apply(drift_first, n, plan.outer[i + 1], &y, force);
        }
        apply(!drift_first, n, plan.inner[s - 1], &y, force);
        const bool apart = task->observer || step == task->steps;
        apply(drift_first, n, apart ? plan.outer[s] : plan.seam, &y, force);
        if (!apart) continue;
        unpack(n, &y, &x);
        if (!observed(&x, task, step)) return TVI_ESTOPPED;
        if (step < task->steps) apply(drift_first, n, plan.outer[0], &y, force);
    }
    return state_end(&x, task, q, p);
}

typedef tvi_status compose_fn(const splitting *m, const baseline_task *task, double q[], double p[]);

#define COMPOSE(name, n, force)                                                                                        \
    static tvi_status name##_kicks(const splitting *m, const baseline_task *task, double q[], double p[])              \
    {                                                                                                                  \
        return compose(n, false, force, m, task, q, p);                                                                \
    }                                                                                                                  \
    static tvi_status name##_drifts(const splitting *m, const baseline_task *task, double q[], double p[])             \
    {                                                                                                                  \
        return compose(n, true, force, m, task, q, p);                                                                 \
    }
COMPOSE(pendulum, 1, pendulum_1)
COMPOSE(kepler, 2, kepler_1)
COMPOSE(henon_heiles, 2, henon_heiles_1)
COMPOSE(fpu, 6, fpu_1)
COMPOSE(solar, ROWS, solar_rows)

#define PAIR(name, n) {name##_kicks, name##_drifts},
static compose_fn *const functions[FORCES][2] = {FORCES_BY_HAND(PAIR)};

static tvi_status run(const baseline *self, const baseline_task *task, double q[], double p[], baseline_counts *counts)
{
    const splitting *m = self->data;
    *counts = (baseline_counts){.steps = task->steps, .force_evaluations = 1 + m->stages * task->steps};
    return functions[force_of(task->scene)][m->drift_first](m, task, q, p);
}

const baseline baselines_composition[] = {
    {.name = "verlet", .order = 2, .data = &verlet, .symplectic = true, .run = run},
    {.name = "blanes-moan", .order = 6, .data = &blanes_moan, .symplectic = true, .run = run},
    {.name = "kahan-li", .order = 8, .data = &kahan_li, .symplectic = true, .run = run},
    {.name = NULL},
};
