/* verlet.c - Makes steps of Stormer-Verlet: the momenta change by half a step of the forces at the start, the
 * coordinates by a step of these momenta, and the momenta by half a step of the forces at the end. In a batch of an
 * ensemble, the members are the lanes of all arrays. */
#include "method/list.h"
#include "method/single.h"
#include "vector.h"

#include <math.h>
#include <string.h>

/* The memory of a stepper, for one integrator or for a batch. */
typedef struct {
    const tvi_system *system;
    tvi_member_stepper *single_stepper; /* Makes the steps of single members that fail in a batch. */
    int width;
    double last_step_size;                          /* The size of the last step. */
    double *force_block;                            /* The block of the tape that computes the forces. */
    double *force_at_start, *force_at_end;          /* [n][width] The forces at the ends of the step. */
    double *dq, *dp;                                /* [n][width] The increments of the step. */
    bool is_outside_domain[VERLET_BATCH_MAX_WIDTH]; /* Tells whether a force of the member has no value. */
} verlet_work;

static void *allocate_members(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width)
{
    verlet_work *taken = tvi_arena_allocate(arena, sizeof *taken);
    verlet_work w = {.system = system, .width = width};
    if (width > 1) {
        tvi_member_stepper single_stepper;
        w.single_stepper = tvi_arena_allocate(arena, sizeof single_stepper);
        tvi_member_stepper_allocate(&single_stepper, arena, tvi_stormer_verlet.stepper, system, options, width, 1);
        if (w.single_stepper) *w.single_stepper = single_stepper;
    }
    w.force_block = tvi_arena_allocate_block(arena, system->field_values, 1, width, 0);
    double **const vectors[] = {&w.force_at_start, &w.force_at_end, &w.dq, &w.dp};
    for (size_t i = 0; i < 4; i++) *vectors[i] = tvi_arena_allocate_doubles(arena, (size_t)system->n * (size_t)width);
    if (taken) *taken = w;
    return taken;
}

/* ---- The step ---------------------------------------------------------------------------------------------------- */

/* Computes force = F at the coordinates in the force block, at the time t + (t_low + time_offset). Returns false if
 * all members are outside of the domain. */
JET_INLINE bool compute_forces(verlet_work *w, int width, const tvi_batch_origin *origin, double time_offset,
                               double *force)
{
    const jet_tape *tape = w->system->field_values;
    const int n = w->system->n;
    int left = width;
    for (int m = 0; w->system->uses_time && m < width; m++)
        w->force_block[n * width + m] = origin->t[m] + (origin->t_low[m] + time_offset);
    if (!tape->sweeps->values(tape, w->force_block, width))
        for (int m = 0; m < width; m++) {
            w->is_outside_domain[m] |=
                width == 1 || !tvi_is_member_inside_domain(w->single_stepper, tape, w->force_block, 1, m);
            left -= w->is_outside_domain[m];
        }
    for (int i = 0; i < n; i++)
        memcpy(force + i * width, w->force_block + tape->output_slot[i] * width, (size_t)width * sizeof *force);
    return left > 0;
}

/* Computes dq = h M^-1 (p0 + h/2 F0) and dp = h/2 (F0 + F1) of all members. Returns the number of force evaluations
 * of each member. */
JET_INLINE int compute_increments(verlet_work *w, int width, double h, const tvi_batch_origin *origin)
{
    const int n = w->system->n;
    w->last_step_size = h;
    memset(w->is_outside_domain, 0, (size_t)width * sizeof *w->is_outside_domain);
    memcpy(w->force_block, origin->q, (size_t)(n * width) * sizeof *w->force_block);
    if (!compute_forces(w, width, origin, 0, w->force_at_start)) return 1;
    for (int i = 0; i < n; i++) {
        const double factor = h / w->system->mass[i];
        for (int at = i * width; at < (i + 1) * width; at++) {
            w->dq[at] = factor * (origin->p[at] + (origin->p_low[at] + h / 2 * w->force_at_start[at]));
            w->force_block[at] = origin->q[at] + (origin->q_low[at] + w->dq[at]);
        }
    }
    (void)compute_forces(w, width, origin, h, w->force_at_end);
    for (int at = 0; at < n * width; at++) w->dp[at] = h / 2 * (w->force_at_start[at] + w->force_at_end[at]);
    return 2;
}

/* Computes bound_of_member [width], bounds of the changes of the members' energies. The kinetic energy changes by (F0 +
 * F1)/2 . dq + h/4 (F1 - F0) . M^-1 dp. The potential changes by -F . dq, with an F between F0 and F1. */
static void bound_energy_change_of_each_member(const void *work, double bound_of_member[])
{
    const verlet_work *w = work;
    const int width = w->width;
    for (int m = 0; m < width; m++) bound_of_member[m] = 0;
    for (int i = 0; i < w->system->n; i++) {
        const double factor = w->last_step_size / w->system->mass[i];
        for (int m = 0, at = i * width; m < width; m++, at++)
            bound_of_member[m] +=
                fabs(w->force_at_end[at] - w->force_at_start[at]) * (fabs(w->dq[at]) + fabs(factor * w->dp[at])) / 2;
    }
}

/* ---- Several members --------------------------------------------------------------------------------------------- */

static int choose_batch_width(const tvi_system *system, const tvi_options *options)
{
    const int bytes = system->field_values->slot_count * (int)sizeof(double);
    int width = BATCH_MIN_WIDTH;
    (void)options;
    while (2 * width <= VERLET_BATCH_MAX_WIDTH && 2 * width * bytes <= VERLET_BATCH_MAX_BYTES) width *= 2;
    return width;
}

/* Sets the tables of the stepper that makes the step of a single member if the batch cannot. */
static void set_tables_of_single_stepper(void *work)
{
    tvi_member_stepper_set_tables(((verlet_work *)work)->single_stepper);
}

static void step_members(void *work, double h, const tvi_batch_origin *origin, const tvi_batch_results *results,
                         tvi_stats *stats)
{
    verlet_work *w = work;
    const jet_tape *tape = w->system->field_values;
    const int forces = compute_increments(w, w->width, h, origin);
    for (int m = 0; m < w->width; m++) {
        if (results->status[m] != TVI_OK) continue;
        if (w->is_outside_domain[m]) {
            (void)tvi_step_member(w->single_stepper, tape, w->force_block, 1, h, origin, results, m, stats);
            continue;
        }
        for (int at = m; at < w->system->n * w->width; at += w->width) {
            results->increments.dq[at] = w->dq[at];
            results->increments.dp[at] = w->dp[at];
        }
        results->tail[m] = 0;
        results->pass_counts[m] = 0;
        stats->force_evaluations += forces;
    }
}

static const tvi_batch_stepper batch_stepper = {.width = choose_batch_width,
                                                .allocate = allocate_members,
                                                .set_tables = set_tables_of_single_stepper,
                                                .step = step_members,
                                                .bound_energy_change = bound_energy_change_of_each_member};

/* ---- One member -------------------------------------------------------------------------------------------------- */

static void *allocate_one_member(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    return allocate_members(arena, system, options, 1);
}

static tvi_status step_one_member(void *work, double h, const tvi_step_origin *origin, const tvi_increments *increments,
                                  tvi_stats *stats)
{
    verlet_work *w = work;
    const tvi_batch_origin batch_origin = tvi_batch_origin_of_one(origin);
    const size_t bytes = (size_t)w->system->n * sizeof(double);
    stats->force_evaluations += compute_increments(w, 1, h, &batch_origin);
    if (w->is_outside_domain[0]) {
        (void)jet_set_error_text_of_failed_sweep(w->system->field_values, w->force_block, 1);
        return TVI_EDOMAIN;
    }
    memcpy(increments->dq, w->dq, bytes);
    memcpy(increments->dp, w->dp, bytes);
    return TVI_OK;
}

/* Evaluates the polynomials of q and p through the ends of the step: p' is linear, from F0 to F1, and q'' is
 * constant, M^-1 F0. */
static void interpolate_one_member(void *work, double theta, double dq[], double dp[])
{
    const verlet_work *w = work;
    for (int i = 0; i < w->system->n; i++) {
        const double bend = w->last_step_size * w->last_step_size / (2 * w->system->mass[i]) * w->force_at_start[i];
        dq[i] = theta * w->dq[i] - theta * (1 - theta) * bend;
        dp[i] = w->last_step_size * theta *
                (w->force_at_start[i] + theta / 2 * (w->force_at_end[i] - w->force_at_start[i]));
    }
}

static double bound_energy_change(const void *work)
{
    double change;
    bound_energy_change_of_each_member(work, &change);
    return change;
}

static tvi_tapes_of_steps list_used_tapes(const tvi_system *system, const tvi_options *options)
{
    return (tvi_tapes_of_steps){.value_tape_emission = {.name_prefix = "tvi_values",
                                                        .value_lane_counts = {1, choose_batch_width(system, options)}}};
}

static const tvi_stepper single_stepper_functions = {.allocate = allocate_one_member,
                                                     .step = step_one_member,
                                                     .interpolate = interpolate_one_member,
                                                     .bound_energy_change = bound_energy_change,
                                                     .list_tapes = list_used_tapes,
                                                     .batch = &batch_stepper};

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
    .stepper = &single_stepper_functions,
};
