/* verlet.c - Makes steps of Stormer-Verlet: the momenta change by half a step of the forces at the start, the
 * coordinates by a step of these momenta, and the momenta by half a step of the forces at the end. */
#include "method/list.h"
#include "method/stepper.h"

#include <math.h>
#include <string.h>

/* The memory of a stepper. */
typedef struct {
    const tvi_system *system;
    double last_step_size;                 /* The size of the last step. */
    double *force_block;                   /* The block of the tape that computes the forces. */
    double *force_at_start, *force_at_end; /* [n] The forces at the ends of the step. */
    double *dq, *dp;                       /* [n] The increments of the step. */
} verlet_work;

static void *allocate(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    verlet_work *taken = tvi_arena_allocate(arena, sizeof *taken);
    verlet_work w = {.system = system};
    (void)options;
    w.force_block = tvi_arena_allocate_block(arena, system->field_values, 1, 1, 0);
    tvi_arena_allocate_each(arena, (size_t)system->n,
                            (double **[]){&w.force_at_start, &w.force_at_end, &w.dq, &w.dp, NULL});
    if (taken) *taken = w;
    return taken;
}

/* Computes force = F at the coordinates in the force block, at the time t + (t_low + time_offset). */
static tvi_status compute_forces(verlet_work *w, const tvi_step_origin *origin, double time_offset, double *force)
{
    const jet_tape *tape = w->system->field_values;
    const int n = w->system->n;
    if (w->system->uses_time) w->force_block[n] = origin->t + (origin->t_low + time_offset);
    if (!tape->sweeps->values(tape, w->force_block, 1)) {
        (void)jet_explain_failed_sweep(tape, w->force_block, 1);
        return TVI_EDOMAIN;
    }
    for (int i = 0; i < n; i++) force[i] = w->force_block[tape->output_slot[i]];
    return TVI_OK;
}

/* Computes dq = h M^-1 (p0 + h/2 F0) and dp = h/2 (F0 + F1). */
static tvi_status step(void *work, double h, const tvi_step_origin *origin, const tvi_increments *increments,
                       tvi_stats *stats)
{
    verlet_work *w = work;
    const int n = w->system->n;
    w->last_step_size = h;
    memcpy(w->force_block, origin->q, (size_t)n * sizeof *w->force_block);
    stats->force_evaluations++;
    tvi_status status = compute_forces(w, origin, 0, w->force_at_start);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) {
        w->dq[i] = h / w->system->mass[i] * (origin->p[i] + (origin->p_low[i] + h / 2 * w->force_at_start[i]));
        w->force_block[i] = origin->q[i] + (origin->q_low[i] + w->dq[i]);
    }
    stats->force_evaluations++;
    status = compute_forces(w, origin, h, w->force_at_end);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) w->dp[i] = h / 2 * (w->force_at_start[i] + w->force_at_end[i]);
    memcpy(increments->dq, w->dq, (size_t)n * sizeof *w->dq);
    memcpy(increments->dp, w->dp, (size_t)n * sizeof *w->dp);
    return TVI_OK;
}

/* Evaluates the polynomials of q and p through the ends of the step: p' is linear, from F0 to F1, and q'' is
 * constant, M^-1 F0. */
static void interpolate(void *work, double theta, double dq[], double dp[])
{
    const verlet_work *w = work;
    for (int i = 0; i < w->system->n; i++) {
        const double bend = w->last_step_size * w->last_step_size / (2 * w->system->mass[i]) * w->force_at_start[i];
        dq[i] = theta * w->dq[i] - theta * (1 - theta) * bend;
        dp[i] = w->last_step_size * theta *
                (w->force_at_start[i] + theta / 2 * (w->force_at_end[i] - w->force_at_start[i]));
    }
}

/* The kinetic energy changes by (F0 + F1)/2 . dq + h/4 (F1 - F0) . M^-1 dp. The potential changes by -F . dq, with an F
 * between F0 and F1. */
static double bound_energy_change(const void *work)
{
    const verlet_work *w = work;
    double bound = 0;
    for (int i = 0; i < w->system->n; i++) {
        const double factor = w->last_step_size / w->system->mass[i];
        bound += fabs(w->force_at_end[i] - w->force_at_start[i]) * (fabs(w->dq[i]) + fabs(factor * w->dp[i])) / 2;
    }
    return bound;
}

static tvi_tapes_of_steps list_tapes(const tvi_system *system, const tvi_options *options)
{
    (void)system, (void)options;
    return (tvi_tapes_of_steps){.value_tape_emission = {.name_prefix = "tvi_values", .value_lane_counts = {1}}};
}

static const tvi_stepper stepper = {.allocate = allocate,
                                    .step = step,
                                    .interpolate = interpolate,
                                    .bound_energy_change = bound_energy_change,
                                    .list_tapes = list_tapes};

static const tvi_supported_forms supported_forms = {
    TVI_SUPPORTS_SEPARABLE, "Stormer-Verlet needs a constant diagonal mass and a force without velocities"};

const tvi_descriptor tvi_stormer_verlet = {
    .method = TVI_STORMER_VERLET,
    .expansion = TVI_AT_START,
    .title = "Stormer-Verlet, start",
    .nodes = {[TVI_NODES_ON_CURVE] = {"stormer-verlet", 0, 2}},
    .least_degree = 1,
    .most_degree = 1,
    .supports = &supported_forms,
    .stepper = &stepper,
};
