/* verlet.c - Stormer-Verlet: half a kick, a drift, half a kick. */
#include "method/list.h"

#include <math.h>
#include <string.h>

typedef struct {
    const tvi_system *system;
    double *x;              /* block of the force's values at one point */
    double *before, *after; /* [n] forces at the ends of the step */
    double *dq, *dp;        /* [n] of the last step */
    double h;
} verlet;

static void *take(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    (void)options;
    verlet *work = tvi_arena_take(arena, sizeof *work);
    const verlet w = {
        .system = system,
        .x = tvi_arena_block(arena, system->field_values, 1, 1, 0),
        .before = tvi_arena_doubles(arena, (size_t)system->n),
        .after = tvi_arena_doubles(arena, (size_t)system->n),
        .dq = tvi_arena_doubles(arena, (size_t)system->n),
        .dp = tvi_arena_doubles(arena, (size_t)system->n),
    };
    if (work) *work = w;
    return work;
}

/* out = F at the coordinates in w->x, which the caller sets. */
static tvi_status kick(verlet *w, double t, double out[], tvi_stats *stats)
{
    const jet_tape *tape = w->system->field_values;
    if (w->system->uses_time) w->x[w->system->n] = t;
    stats->force_evaluations++;
    if (!jet_sweep_values(tape, w->x, 1)) return TVI_EDOMAIN;
    for (int i = 0; i < w->system->n; i++) out[i] = w->x[tape->output[i]];
    return TVI_OK;
}

/* dq = h M^-1 (p0 + h/2 F0),  dp = h/2 (F0 + F1). */
static tvi_status step(void *work, double h, const tvi_origin *origin, const tvi_increments *by, tvi_stats *stats)
{
    double *dq = by->dq, *dp = by->dp;
    verlet *w = work;
    const int n = w->system->n;
    memcpy(w->x, origin->q, (size_t)n * sizeof *w->x);
    tvi_status status = kick(w, origin->t + origin->t_low, w->before, stats);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) {
        dq[i] = h / w->system->mass[i] * (origin->p[i] + (origin->p_low[i] + h / 2 * w->before[i]));
        w->x[i] = origin->q[i] + (origin->q_low[i] + dq[i]);
    }
    status = kick(w, origin->t + (origin->t_low + h), w->after, stats);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) dp[i] = h / 2 * (w->before[i] + w->after[i]);
    memcpy(w->dq, dq, (size_t)n * sizeof *dq);
    memcpy(w->dp, dp, (size_t)n * sizeof *dp);
    w->h = h;
    return TVI_OK;
}

/* Polynomials through the ends: dq with the accelerations at the ends of the step as slopes of the momentum. */
static void dense(void *work, double theta, double dq[], double dp[])
{
    const verlet *w = work;
    for (int i = 0; i < w->system->n; i++) {
        const double bend = w->h * w->h / (2 * w->system->mass[i]) * w->before[i];
        dq[i] = theta * w->dq[i] - theta * (1 - theta) * bend;
        dp[i] = w->h * theta * (w->before[i] + theta / 2 * (w->after[i] - w->before[i]));
    }
}

/* The change of T is (F0 + F1)/2 . dq + h/4 (F1 - F0) . M^-1 dp, that of V -F . dq with an F between F0 and F1. */
static double most_change(const void *work)
{
    const verlet *w = work;
    double sum = 0;
    for (int i = 0; i < w->system->n; i++)
        sum += fabs(w->after[i] - w->before[i]) * (fabs(w->dq[i]) + fabs(w->h / w->system->mass[i] * w->dp[i]));
    return sum / 2;
}

static tvi_uses uses(const tvi_system *system, const tvi_options *options)
{
    return (tvi_uses){.values = {.name = "tvi_values", .lanes = {1, tvi_verlet_batch.width(system, options)}}};
}

static const tvi_stepper stepper = {
    .take = take, .step = step, .dense = dense, .most_change = most_change, .uses = uses, .batch = &tvi_verlet_batch};

static const tvi_service service = {TVI_SERVES_SEPARABLE,
                                    "Stormer-Verlet needs a constant diagonal mass and a force without velocities"};

const tvi_descriptor tvi_stormer_verlet = {
    .method = TVI_STORMER_VERLET,
    .expansion = TVI_AT_START,
    .title = "Stormer-Verlet, start",
    .nodes = {[TVI_NODES_ON_CURVE] = {"stormer-verlet", 0, 2}},
    .least_degree = 1,
    .most_degree = 1,
    .serves = &service,
    .stepper = &stepper,
};
