/* verlet.c - Makes steps of Stormer-Verlet: the momenta change by half a step of the forces at the start, the
 * coordinates by a step of these momenta, and the momenta by half a step of the forces at the end. On constraints this
 * is RATTLE (Andersen, J. Comput. Phys. 52, 1983): the impulse -G^T mu at the start takes the coordinates at the end
 * onto phi = 0, and that at the end takes the momenta onto G v + phi_t = 0. */
#include "algebra/sizes.h"
#include "method/list.h"
#include "method/stepper.h"
#include "system/constraint.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The memory of a stepper. */
typedef struct {
    const tvi_system *system;
    double last_step_size;                 /* The size of the last step. */
    double *force_block;                   /* The block of the tape that computes the forces. */
    double *force_at_start, *force_at_end; /* [n] The forces at the ends of the step. */
    double *dq, *dp;                       /* [n] The increments of the step. */
    /* On constraints: the constraints at one state, [entries] G at the start, [m] multipliers and residuals, [n] the
     * state at the end, and the impulses of the constraints. */
    tvi_constraint_work at;
    double *start_G, *mu, *residual, *q, *p, *impulse;
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

/* On the straight line between the ends M^-1 V'' somewhere has an eigenvalue of this size, w^2, or a larger one. */
static double compute_phase(const void *work)
{
    const verlet_work *w = work;
    double force = 0, way = 0;
    for (int i = 0; i < w->system->n; i++) {
        const double d = w->force_at_end[i] - w->force_at_start[i];
        force += d * d / w->system->mass[i];
        way += w->dq[i] * w->dq[i] * w->system->mass[i];
    }
    return force == 0 ? 0 : fabs(w->last_step_size) * sqrt(sqrt(force / way));
}

/* ---- RATTLE ------------------------------------------------------------------------------------------------------ */

enum { RATTLE_PASSES = 50 };

static void *allocate_rattle(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    verlet_work *w = allocate(arena, system, options), measured = {.system = system}, *to = w ? w : &measured;
    const tvi_constraints *c = system->constraints;
    tvi_constraint_allocate(&to->at, arena, system);
    to->start_G = tvi_arena_allocate_doubles(arena, (size_t)c->entry_count);
    tvi_arena_allocate_each(arena, (size_t)c->count, (double **[]){&to->mu, &to->residual, NULL});
    tvi_arena_allocate_each(arena, (size_t)system->n, (double **[]){&to->q, &to->p, &to->impulse, NULL});
    return w;
}

/* impulse = -G^T mu, with G at the start. */
static void set_impulse(const verlet_work *w)
{
    const tvi_constraints *c = w->system->constraints;
    memset(w->impulse, 0, (size_t)w->system->n * sizeof *w->impulse);
    for (int k = 0, e = 0; k < c->count; k++)
        for (; e < c->row_end[k]; e++)
            w->impulse[tvi_constraint_momentum(c, w->system->n, c->column[e])] -=
                w->start_G[e] * w->mu[tvi_constraint_multiplier(c, k)];
}

/* Sets q at the end of the step, from the force and the impulse at its start. Returns by how much of its size it moves.
 */
static double set_end(verlet_work *w, double h, const tvi_step_origin *origin)
{
    const tvi_system *system = w->system;
    double moved = 0, size = DBL_MIN;
    for (int i = 0; i < system->n; i++) {
        const double p = origin->p[i] + (origin->p_low[i] + (h / 2 * w->force_at_start[i] + w->impulse[i])),
                     dq = h / system->mass[i] * p;
        moved = tvi_larger(moved, fabs(dq - w->dq[i]));
        w->dq[i] = dq;
        w->q[i] = origin->q[i] + (origin->q_low[i] + dq);
        size = tvi_larger(size, fabs(w->q[i]) + fabs(dq));
    }
    return moved / size;
}

/* Finds the multipliers of the start, mu = h lambda / 2, which take q at the end onto phi = 0, by Newton's method with
 * the matrix S of the start. A pass is the last one if it moves q by no more than roundoff, or, where q hardly moves,
 * no longer less than the one before. */
static tvi_status find_start_impulse(verlet_work *w, double h, const tvi_step_origin *origin, tvi_stats *stats)
{
    const int m = w->system->constraints->count;
    double before = INFINITY;
    for (int pass = 0; pass < RATTLE_PASSES; pass++) {
        set_impulse(w);
        const double moved = set_end(w, h, origin);
        if (!isfinite(moved)) return TVI_ENONFINITE;
        if (pass > 0 && (moved <= DBL_EPSILON || (before < 0x1p-26 && moved >= before / 2))) return TVI_OK;
        if (pass > 0) before = moved; /* the first pass moves from the step before */
        const tvi_status status = tvi_constraint_phi(&w->at, origin->t + (origin->t_low + h), w->q, w->residual);
        if (status != TVI_OK) return status;
        stats->passes++;
        tvi_constraint_solve(&w->at, w->residual);
        for (int k = 0; k < m; k++) w->mu[k] += w->residual[k] / h;
    }
    return TVI_ENOCONV;
}

/* Adds the impulse at the end, which takes the momenta w->p onto G v + phi_t = 0, to them and to w->impulse, which is
 * cleared first. A second round removes the roundoff of the first. */
static tvi_status find_end_impulse(verlet_work *w, double t)
{
    const int n = w->system->n;
    tvi_status status = tvi_constraint_factor(&w->at, t, w->q, w->p);
    memset(w->impulse, 0, (size_t)n * sizeof *w->impulse);
    for (int round = 0; round < 2 && status == TVI_OK; round++) {
        status = tvi_constraint_evaluate(&w->at, t, w->q, w->p, w->mu, w->residual);
        if (status != TVI_OK) return status;
        tvi_constraint_solve(&w->at, w->residual);
        tvi_constraint_force(&w->at, w->residual, w->dp);
        for (int i = 0; i < n; i++) {
            w->p[i] += w->dp[i];
            w->impulse[i] += w->dp[i];
        }
    }
    return status;
}

/* Makes a step. force_at_start and force_at_end become the forces with those of constraint. */
static tvi_status step_rattle(void *work, double h, const tvi_step_origin *origin, const tvi_increments *increments,
                              tvi_stats *stats)
{
    verlet_work *w = work;
    const int n = w->system->n;
    w->last_step_size = h;
    memcpy(w->force_block, origin->q, (size_t)n * sizeof *w->force_block);
    stats->force_evaluations += 2;
    tvi_status status = compute_forces(w, origin, 0, w->force_at_start);
    if (status == TVI_OK) status = tvi_constraint_factor(&w->at, origin->t, origin->q, origin->p);
    if (status != TVI_OK) return status;
    memset(w->mu, 0, (size_t)w->system->constraints->count * sizeof *w->mu);
    tvi_constraint_get_G(&w->at, w->start_G);
    status = find_start_impulse(w, h, origin, stats);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) w->force_at_start[i] += 2 / h * w->impulse[i];
    memcpy(w->force_block, w->q, (size_t)n * sizeof *w->force_block);
    status = compute_forces(w, origin, h, w->force_at_end);
    for (int i = 0; i < n && status == TVI_OK; i++)
        w->p[i] = origin->p[i] + (origin->p_low[i] + h / 2 * (w->force_at_start[i] + w->force_at_end[i]));
    if (status == TVI_OK) status = find_end_impulse(w, origin->t + (origin->t_low + h));
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) {
        w->force_at_end[i] += 2 / h * w->impulse[i];
        w->dp[i] = h / 2 * (w->force_at_start[i] + w->force_at_end[i]);
    }
    memcpy(increments->dq, w->dq, (size_t)n * sizeof *w->dq);
    memcpy(increments->dp, w->dp, (size_t)n * sizeof *w->dp);
    return TVI_OK;
}

/* No bound is known: the energy is computed after each step. */
static double do_not_bound_energy(const void *work)
{
    (void)work;
    return INFINITY;
}

static tvi_tapes_of_steps list_tapes(const tvi_system *system, const tvi_options *options)
{
    (void)system, (void)options;
    return (tvi_tapes_of_steps){.value_tape_emission = {.name_prefix = "tvi_values", .value_lane_counts = {1}}};
}

static tvi_tapes_of_steps list_tapes_of_rattle(const tvi_system *system, const tvi_options *options)
{
    tvi_tapes_of_steps tapes = list_tapes(system, options);
    tapes.constraint_tape_emission = (jet_emission_request){.name_prefix = "tvi_constraints", .value_lane_counts = {1}};
    return tapes;
}

/* The forces at both ends of a step. */
static int quadrature(const void *work, double theta[], double b[])
{
    (void)work;
    theta[0] = 0, theta[1] = 1;
    b[0] = b[1] = 0.5;
    return 2;
}

static void at_nodes(void *work, const double q_start[], const double p_start[], double *q, double *p)
{
    const verlet_work *w = work;
    (void)p_start, (void)p;
    for (int i = 0; i < w->system->n; i++) {
        q[2 * i] = q_start[i];
        q[2 * i + 1] = q_start[i] + w->dq[i];
    }
}

static const tvi_stepper stepper = {.allocate = allocate,
                                    .step = step,
                                    .interpolate = interpolate,
                                    .quadrature = quadrature,
                                    .at_nodes = at_nodes,
                                    .bound_energy_change = bound_energy_change,
                                    .compute_phase = compute_phase,
                                    .stable_phase = 2,
                                    .list_tapes = list_tapes};

static const tvi_stepper rattle_stepper = {.allocate = allocate_rattle,
                                           .step = step_rattle,
                                           .interpolate = interpolate,
                                           .bound_energy_change = do_not_bound_energy,
                                           .list_tapes = list_tapes_of_rattle};

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
    .constrained = &rattle_stepper,
};
