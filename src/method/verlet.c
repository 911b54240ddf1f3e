/* verlet.c - Makes steps of Stormer-Verlet: half a kick, a drift, half a kick. An integrator has one member. Members of
 * an ensemble are lanes: number m of a row is member m. */
#include "method/list.h"
#include "method/single.h"
#include "vector.h"

#include <math.h>
#include <string.h>

enum { MOST_WIDTH = 64, LEAST_WIDTH = 8, MOST_BYTES = 16 << 10 };

typedef struct {
    const tvi_system *system;
    tvi_single *single_stepper; /* of several members: makes the steps that fail */
    int width;
    double h;               /* of the last step */
    double *x;              /* block of the force's values */
    double *before, *after; /* [n][width] forces at the ends of the step */
    double *dq, *dp;        /* [n][width] */
    bool is_outside[MOST_WIDTH];
} verlet;

static void *take_members(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width)
{
    verlet *taken = tvi_arena_take(arena, sizeof *taken);
    verlet w = {.system = system, .width = width};
    if (width > 1) {
        tvi_single single_stepper;
        w.single_stepper = tvi_arena_take(arena, sizeof single_stepper);
        tvi_single_take(&single_stepper, arena, tvi_stormer_verlet.stepper, system, options, width, 1);
        if (w.single_stepper) *w.single_stepper = single_stepper;
    }
    w.x = tvi_arena_block(arena, system->field_values, 1, width, 0);
    double **const vectors[] = {&w.before, &w.after, &w.dq, &w.dp};
    for (size_t i = 0; i < 4; i++) *vectors[i] = tvi_arena_doubles(arena, (size_t)system->n * (size_t)width);
    if (taken) *taken = w;
    return taken;
}

/* ---- The step ---------------------------------------------------------------------------------------------------- */

/* Computes out = F at the coordinates in w->x, at time t + (t_low + later). Returns false if no member is left in the
 * domain. */
JET_INLINE bool kick(verlet *w, int width, const tvi_batch_origin *origin, double later, double *out)
{
    const jet_tape *tape = w->system->field_values;
    const int n = w->system->n;
    int left = width;
    for (int m = 0; w->system->uses_time && m < width; m++)
        w->x[n * width + m] = origin->t[m] + (origin->t_low[m] + later);
    if (!tape->sweeps->values(tape, w->x, width))
        for (int m = 0; m < width; m++) {
            w->is_outside[m] |= width == 1 || !tvi_single_is_inside(w->single_stepper, tape, w->x, 1, m);
            left -= w->is_outside[m];
        }
    for (int i = 0; i < n; i++) memcpy(out + i * width, w->x + tape->output[i] * width, (size_t)width * sizeof *out);
    return left > 0;
}

/* Computes dq = h M^-1 (p0 + h/2 F0), dp = h/2 (F0 + F1) of all members. Returns the number of forces of each. */
JET_INLINE int move_members(verlet *w, int width, double h, const tvi_batch_origin *origin)
{
    const int n = w->system->n;
    w->h = h;
    memset(w->is_outside, 0, (size_t)width * sizeof *w->is_outside);
    memcpy(w->x, origin->q, (size_t)(n * width) * sizeof *w->x);
    if (!kick(w, width, origin, 0, w->before)) return 1;
    for (int i = 0; i < n; i++) {
        const double factor = h / w->system->mass[i];
        for (int at = i * width; at < (i + 1) * width; at++) {
            w->dq[at] = factor * (origin->p[at] + (origin->p_low[at] + h / 2 * w->before[at]));
            w->x[at] = origin->q[at] + (origin->q_low[at] + w->dq[at]);
        }
    }
    (void)kick(w, width, origin, h, w->after);
    for (int at = 0; at < n * width; at++) w->dp[at] = h / 2 * (w->before[at] + w->after[at]);
    return 2;
}

/* Bounds the changes of the energies. The change of T is (F0 + F1)/2 . dq + h/4 (F1 - F0) . M^-1 dp, that of V is -F .
 * dq with an F between F0 and F1. */
JET_INLINE void most_changes(const verlet *w, int width, double change[])
{
    for (int m = 0; m < width; m++) change[m] = 0;
    for (int i = 0; i < w->system->n; i++) {
        const double factor = w->h / w->system->mass[i];
        for (int m = 0, at = i * width; m < width; m++, at++)
            change[m] += fabs(w->after[at] - w->before[at]) * (fabs(w->dq[at]) + fabs(factor * w->dp[at])) / 2;
    }
}

/* ---- Several members --------------------------------------------------------------------------------------------- */

static int width_of(const tvi_system *system, const tvi_options *options)
{
    const int bytes = system->field_values->slots * (int)sizeof(double);
    int width = LEAST_WIDTH;
    (void)options;
    while (2 * width <= MOST_WIDTH && 2 * width * bytes <= MOST_BYTES) width *= 2;
    return width;
}

static void prepare_members(void *work) { tvi_single_prepare(((verlet *)work)->single_stepper); }

static void step_members(void *work, double h, const tvi_batch_origin *origin, const tvi_batch_end *end,
                         tvi_stats *stats)
{
    verlet *w = work;
    const jet_tape *tape = w->system->field_values;
    const int forces = move_members(w, w->width, h, origin);
    for (int m = 0; m < w->width; m++) {
        if (end->status[m] != TVI_OK) continue;
        if (w->is_outside[m]) {
            (void)tvi_single_step(w->single_stepper, tape, w->x, 1, h, origin, end, m, stats);
            continue;
        }
        for (int at = m; at < w->system->n * w->width; at += w->width) {
            end->increments.dq[at] = w->dq[at];
            end->increments.dp[at] = w->dp[at];
        }
        end->tail[m] = 0;
        end->passes[m] = 0;
        stats->force_evaluations += forces;
    }
}

static void most_changes_of_members(const void *work, double change[])
{
    const verlet *w = work;
    most_changes(w, w->width, change);
}

/* The stepper of a batch, which leaves no history. */
static const tvi_batch_stepper members = {.width = width_of,
                                          .take = take_members,
                                          .prepare = prepare_members,
                                          .step = step_members,
                                          .most_change = most_changes_of_members};

/* ---- One member -------------------------------------------------------------------------------------------------- */

static void *take(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    return take_members(arena, system, options, 1);
}

static tvi_status step(void *work, double h, const tvi_origin *origin, const tvi_increments *increments,
                       tvi_stats *stats)
{
    verlet *w = work;
    const tvi_batch_origin of_one = {&origin->t, &origin->t_low, origin->q, origin->q_low, origin->p, origin->p_low};
    const size_t bytes = (size_t)w->system->n * sizeof(double);
    stats->force_evaluations += move_members(w, 1, h, &of_one);
    if (w->is_outside[0]) {
        (void)jet_refuse_sweep(w->system->field_values, w->x, 1);
        return TVI_EDOMAIN;
    }
    memcpy(increments->dq, w->dq, bytes);
    memcpy(increments->dp, w->dp, bytes);
    return TVI_OK;
}

/* Evaluates polynomials through the ends. dq has the accelerations at both ends as slopes of the momentum. */
static void dense(void *work, double theta, double dq[], double dp[])
{
    const verlet *w = work;
    for (int i = 0; i < w->system->n; i++) {
        const double bend = w->h * w->h / (2 * w->system->mass[i]) * w->before[i];
        dq[i] = theta * w->dq[i] - theta * (1 - theta) * bend;
        dp[i] = w->h * theta * (w->before[i] + theta / 2 * (w->after[i] - w->before[i]));
    }
}

static double most_change(const void *work)
{
    double change;
    most_changes(work, 1, &change);
    return change;
}

static tvi_used_tapes uses(const tvi_system *system, const tvi_options *options)
{
    return (tvi_used_tapes){.values = {.name = "tvi_values", .lanes = {1, width_of(system, options)}}};
}

static const tvi_stepper stepper = {
    .take = take, .step = step, .dense = dense, .most_change = most_change, .uses = uses, .batch = &members};

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
