/* batch.c - Makes steps of the Galerkin curves of several members of an ensemble at once, by the text of steps.h.
 * Number i * width + m of a row is node i of member m.
 *
 * Each member has its own convergence: a member that has converged moves no more, and the others go on. A step in lanes
 * continues a step of the same size. All other steps, as the first one of a run, and steps that fail or whose roundoff
 * has to be measured, are made by the stepper of a single curve, one after the other. */
#include "compiled/code.h"
#include "galerkin/step.h"
#include "method/single.h"

enum { MOST_LANES = 256, LEAST_WIDTH = 8 };
/* The largest block of the tape, which is partly in the second-level cache. A block of the least width may be larger,
 * except if a whole step is generated code, which then is faster. */
enum { MOST_BYTES = 40 << 10, MOST_BYTES_OF_ALL = 128 << 10 };

/* The last two steps of each member, as in galerkin_history, [width] each. */
typedef struct {
    double *h, *h_before, *t;
    galerkin_convergence *convergence;
} batch_history;

typedef struct {
    tvi_member_stepper single_stepper;
    galerkin *single; /* work of the single stepper, which has all tables */
    galerkin_nodes nodes;
    galerkin_tail_inputs tail_inputs;
    galerkin_frame frame;
    galerkin_verdicts verdicts;
    /* [width] All bits, or none: the member steps in lanes; the result of galerkin_is_rough. */
    long long *in_lanes, *is_rough;
    tvi_increments increments; /* [n][width] each */
    double *share, *ratio;     /* [n][width] */
    double *tail;              /* [width] */
    /* In the arena's history, with the impulses and the index of the last ones. */
    batch_history last;
    long *ring_index;
    double *impulses[GALERKIN_RING]; /* [unknowns][points][width] of the last two steps and of the next one */
} batch;

/* ---- Memory and tables ------------------------------------------------------------------------------------------- */

static const galerkin_loops *const *const loops_of[JET_ISA_COUNT] = {
    [jet_isa_base] = &tvi_galerkin_members_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = &tvi_galerkin_members_avx2,
    [jet_isa_avx512] = &tvi_galerkin_members_avx512,
#endif
};

static int width_of(const tvi_system *system, const tvi_options *options)
{
    const int points = options->degree, bytes = system->field_values->slots * points * (int)sizeof(double);
    if (!tvi_galerkin_is_plain(system) || options->passes == TVI_PREDICT_ONLY) return 1;
    const bool has_steps = system->code && system->code->galerkin;
    if (LEAST_WIDTH * bytes > (has_steps ? MOST_BYTES : MOST_BYTES_OF_ALL)) return 1;
    int width = LEAST_WIDTH;
    while (2 * width <= GALERKIN_MOST_WIDTH && 2 * width * points <= MOST_LANES && 2 * width * bytes <= MOST_BYTES)
        width *= 2;
    return width;
}

static void take_nodes(galerkin_nodes *nodes, tvi_arena *arena, const tvi_system *system, int points, int width)
{
    const size_t of_unknowns = (size_t)system->inputs * (size_t)width, numbers = of_unknowns * (size_t)points;
    *nodes = (galerkin_nodes){.unknowns = system->inputs, .half = system->n, .points = points, .width = width};
    nodes->x = tvi_arena_allocate_block(arena, system->field_values, 1, points * width, 0);
    nodes->start = tvi_arena_doubles(arena, of_unknowns);
    nodes->high = tvi_arena_doubles(arena, numbers);
    nodes->base = tvi_arena_doubles(arena, numbers);
    nodes->inverse_size = tvi_arena_doubles(arena, of_unknowns);
}

static void take_history(batch *w, tvi_arena *arena, size_t numbers)
{
    const size_t width = (size_t)w->nodes.width;
    double **const of_last[] = {&w->last.h, &w->last.h_before, &w->last.t};
    for (size_t i = 0; i < 3; i++) *of_last[i] = tvi_arena_allocate_history(arena, width * sizeof(double));
    w->last.convergence = tvi_arena_allocate_history(arena, width * sizeof *w->last.convergence);
    w->ring_index = tvi_arena_allocate_history(arena, sizeof *w->ring_index);
    for (int i = 0; i < GALERKIN_RING; i++)
        w->impulses[i] = tvi_arena_allocate_history(arena, numbers * sizeof(double));
}

static void *take(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width)
{
    batch *taken = tvi_arena_allocate(arena, sizeof *taken);
    batch w = {.ring_index = NULL};
    tvi_member_stepper_allocate(&w.single_stepper, arena, &tvi_stepper_galerkin, system, options, width,
                                options->degree);
    w.single = w.single_stepper.work;
    take_nodes(&w.nodes, arena, system, options->degree, width);
    const size_t count = (size_t)width, n = (size_t)system->n * count, unknowns = (size_t)system->inputs * count;
    galerkin_sums *sums = &w.tail_inputs.sums;
    double **const of_unknowns[] = {&sums->once,     &sums->twice,     &sums->last,    &sums->reach,
                                    &sums->once_low, &sums->twice_low, &w.frame.drift, &w.frame.drift_low};
    double **const of_n[] = {&w.increments.dq,     &w.increments.dp, &w.increments.dq_low,
                             &w.increments.dp_low, &w.share,         &w.ratio};
    for (size_t i = 0; i < 8; i++) *of_unknowns[i] = tvi_arena_doubles(arena, unknowns);
    for (size_t i = 0; i < 6; i++) *of_n[i] = tvi_arena_doubles(arena, n);
    w.tail = tvi_arena_doubles(arena, count);
    w.in_lanes = tvi_arena_allocate(arena, count * sizeof *w.in_lanes);
    w.is_rough = tvi_arena_allocate(arena, count * sizeof *w.is_rough);
    take_history(&w, arena, unknowns * (size_t)options->degree);
    if (taken) *taken = w;
    return taken;
}

static void prepare(void *work)
{
    batch *w = work;
    galerkin *single = w->single;
    galerkin_nodes *nodes = &w->nodes;
    double *const drift = w->frame.drift, *const drift_low = w->frame.drift_low;
    tvi_member_stepper_prepare(&w->single_stepper);
    const galerkin_nodes *of_one = &single->field.nodes;
    nodes->is_moving = w->verdicts.is_moving;
    nodes->lanes = of_one->lanes;
    nodes->moving = of_one->moving;
    nodes->weight = of_one->weight;
    nodes->scale = of_one->scale;
    nodes->per_movement = of_one->per_movement;
    nodes->parts = of_one->parts;
    const galerkin_sums sums = w->tail_inputs.sums;
    w->tail_inputs = single->tail_inputs;
    w->tail_inputs.sums = sums;
    w->frame = single->frame;
    w->frame.loops = *loops_of[single->field.system->field_values->sweeps->isa];
    w->frame.nodes = nodes;
    w->frame.tail_inputs = &w->tail_inputs;
    w->frame.drift = drift;
    w->frame.drift_low = drift_low;
    w->frame.share = w->share;
    w->frame.ratio = w->ratio;
    w->frame.impulses = w->impulses;
}

/* ---- Members one by one ------------------------------------------------------------------------------------------ */

/* Copies impulses from [unknowns][points][width] to [unknowns][lanes]. */
static void gather_impulses(const batch *w, const double *from, int m, double *to)
{
    const galerkin_nodes *nodes = &w->nodes;
    for (int u = 0; u < nodes->unknowns; u++)
        tvi_gather_member(nodes->points, nodes->width, from + u * nodes->points * nodes->width, m,
                          to + u * nodes->lanes);
}

static void scatter_impulses(const batch *w, const double *from, int m, double *to)
{
    const galerkin_nodes *nodes = &w->nodes;
    for (int u = 0; u < nodes->unknowns; u++)
        tvi_scatter_member(nodes->points, nodes->width, from + u * nodes->lanes, m,
                           to + u * nodes->points * nodes->width);
}

static double *impulses(const batch *w, int after_last)
{
    return galerkin_ring_buffer(&w->frame, (int)*w->ring_index + after_last);
}

/* Copies the history of a lane to the single stepper's. */
static void lane_to_scalar(const void *work, int lane, void *scalar)
{
    const batch *w = work;
    const galerkin_predictor *predictor = &((galerkin *)scalar)->predictor;
    const batch_history *last = &w->last;
    *predictor->last = (galerkin_history){.h = last->h[lane],
                                          .h_before = last->h_before[lane],
                                          .t = last->t[lane],
                                          .convergence = last->convergence[lane]};
    for (int i = 0; i < 2; i++) gather_impulses(w, impulses(w, -i), lane, tvi_galerkin_impulses(predictor, -i));
}

static void scalar_to_lane(void *work, int lane, const void *scalar)
{
    const batch *w = work;
    const galerkin_predictor *predictor = &((const galerkin *)scalar)->predictor;
    w->last.h[lane] = predictor->last->h;
    w->last.h_before[lane] = predictor->last->h_before;
    w->last.t[lane] = predictor->last->t;
    w->last.convergence[lane] = predictor->last->convergence;
    for (int i = 0; i < 2; i++) scatter_impulses(w, tvi_galerkin_impulses(predictor, -i), lane, impulses(w, -i));
}

static void forget(void *work, int lane)
{
    const batch *w = work;
    w->last.h[lane] = w->last.h_before[lane] = w->last.t[lane] = 0;
    w->last.convergence[lane] = (galerkin_convergence){0};
}

static bool is_sound(const void *work)
{
    const long ring_index = *((const batch *)work)->ring_index;
    return ring_index >= 0 && ring_index < GALERKIN_RING;
}

static void step_by_itself(batch *w, double h, const tvi_batch_origin *origin, const tvi_batch_results *end, int m,
                           tvi_stats *stats)
{
    const jet_tape *tape = w->single->field.system->field_values;
    lane_to_scalar(w, m, w->single);
    if (tvi_step_member(&w->single_stepper, tape, w->nodes.x, w->nodes.points, h, origin, end, m, stats))
        scalar_to_lane(w, m, w->single);
}

/* ---- Members in lanes -------------------------------------------------------------------------------------------- */

/* Selects the members whose step continues one of size h that ended at t. Returns how many they are. */
static int select_lanes(batch *w, double h, const double t[], const tvi_status status[])
{
    const batch_history *last = &w->last;
    int count = 0;
    for (int m = 0; m < w->nodes.width; m++) {
        const bool goes_on = status[m] == TVI_OK && last->h[m] == h && fabs(t[m] - (last->t[m] + h)) < 0.25 * fabs(h);
        w->verdicts.slowest[m] = last->convergence[m].slowest;
        w->in_lanes[m] = w->verdicts.is_moving[m] = goes_on ? -1 : 0;
        w->is_rough[m] = galerkin_is_rough(&w->frame, last->h_before[m] == h ? 2 : 1, last->convergence[m].first);
        count += goes_on;
    }
    return count;
}

/* Holds a member that steps by itself at its start, so that it does not disturb the sweeps. */
static void hold(batch *w, int m)
{
    const galerkin_nodes *nodes = &w->nodes;
    w->verdicts.is_moving[m] = 0;
    for (int at = m; at < nodes->unknowns * nodes->points * nodes->width; at += nodes->width) {
        nodes->impulse[at] = nodes->base[at] = 0;
        nodes->high[at] = nodes->start[at / (nodes->points * nodes->width) * nodes->width + m];
    }
}

static void set_times(const batch *w, double h, const tvi_batch_origin *origin)
{
    const galerkin_nodes *nodes = &w->nodes;
    double *t = nodes->x + nodes->unknowns * nodes->points * nodes->width;
    if (!w->single->field.system->uses_time) return;
    for (int i = 0; i < nodes->points; i++)
        for (int m = 0; m < nodes->width; m++)
            *t++ = origin->t[m] + (origin->t_low[m] + h * w->single->coefficients.c[i]);
}

/* A step of all members in lanes. */
typedef struct {
    batch *w;
    tvi_stats *stats;
} lanes_step;

/* Evaluates a pass. Members outside of the domain are left to step by themselves. */
static tvi_status pass(void *work, const galerkin_nodes *nodes, double moved[], double *roundoff)
{
    const lanes_step *step = work;
    batch *w = step->w;
    const galerkin_field *field = &w->single->field;
    const jet_tape *tape = field->system->field_values;
    const bool is_inside = tape->sweeps->values(tape, nodes->x, nodes->points * nodes->width);
    (void)roundoff;
    for (int m = 0; m < nodes->width; m++) {
        if (!nodes->is_moving[m]) continue;
        step->stats->force_evaluations += nodes->points;
        step->stats->passes++;
        if (!is_inside && !tvi_is_member_inside_domain(&w->single_stepper, tape, nodes->x, nodes->points, m))
            hold(w, m);
    }
    w->frame.loops->move(nodes, w->frame.matrix, nodes->x, field->slot, moved);
    return TVI_OK;
}

static void solve(batch *w, double h, const tvi_batch_origin *origin, const tvi_origin *from, tvi_stats *stats)
{
    const galerkin_nodes *nodes = &w->nodes;
    const galerkin_extrapolation by = galerkin_from_steps(&w->frame, (int)*w->ring_index, w->is_rough);
    lanes_step step = {w, stats};
    galerkin_start(&w->frame, nodes, from);
    for (int m = 0; m < nodes->width; m++)
        if (!w->in_lanes[m]) hold(w, m);
    w->frame.loops->predict(nodes, &by);
    set_times(w, h, origin);
    w->frame.loops->set_sizes(nodes, w->single->n);
    galerkin_solve_members(&w->frame, nodes, &(galerkin_solver){.pass = pass, .work = &step}, &w->verdicts);
    for (int m = 0; m < nodes->width; m++) w->in_lanes[m] = w->verdicts.has_ended[m];
}

/* Keeps the impulses of members that step by themselves, or do not step. */
static void keep_impulses(const batch *w)
{
    const int width = w->nodes.width, rows = w->nodes.unknowns * w->nodes.points;
    double *const before = impulses(w, -1), *const last = impulses(w, 0), *const next = impulses(w, 1);
    for (int m = 0; m < width; m++)
        for (int at = m; at < rows * width && !w->in_lanes[m]; at += width) {
            next[at] = last[at];
            last[at] = before[at];
        }
    *w->ring_index = (*w->ring_index + 1) % GALERKIN_RING;
}

/* Copies rows of the members in lanes. */
static void copy_lanes(const batch *w, int rows, const double *from, double *to)
{
    const int width = w->nodes.width;
    for (int i = 0; i < rows; i++, from += width, to += width)
        for (int m = 0; m < width; m++) to[m] = w->in_lanes[m] ? from[m] : to[m];
}

static void finish(batch *w, double h, const tvi_batch_origin *origin, const tvi_origin *from,
                   const tvi_batch_results *end)
{
    const int n = w->single->n;
    galerkin_end_step(&w->frame, &w->nodes, from, &w->increments, w->tail);
    keep_impulses(w);
    copy_lanes(w, n, w->increments.dq, end->increments.dq);
    copy_lanes(w, n, w->increments.dp, end->increments.dp);
    copy_lanes(w, n, w->increments.dq_low, end->increments.dq_low);
    copy_lanes(w, n, w->increments.dp_low, end->increments.dp_low);
    copy_lanes(w, 1, w->tail, end->tail);
    copy_lanes(w, 1, origin->t, w->last.t);
    for (int m = 0; m < w->nodes.width; m++) {
        if (!w->in_lanes[m]) continue;
        w->last.h_before[m] = h;
        w->last.convergence[m] = (galerkin_convergence){w->verdicts.slowest[m], w->verdicts.first[m]};
        end->passes[m] = (int)w->verdicts.count[m];
    }
}

static void step(void *work, double h, const tvi_batch_origin *origin, const tvi_batch_results *end, tvi_stats *stats)
{
    batch *w = work;
    const tvi_origin from = {0, 0, origin->q, origin->q_low, origin->p, origin->p_low};
    tvi_galerkin_set_size(w->single, h);
    w->nodes.impulse = impulses(w, 1);
    if (select_lanes(w, h, origin->t, end->status) > 0) {
        solve(w, h, origin, &from, stats);
        finish(w, h, origin, &from, end);
    }
    for (int m = 0; m < w->nodes.width; m++)
        if (end->status[m] == TVI_OK && !w->in_lanes[m]) step_by_itself(w, h, origin, end, m, stats);
}

const tvi_batch_stepper tvi_galerkin_batch = {.width = width_of,
                                              .take = take,
                                              .prepare = prepare,
                                              .step = step,
                                              .lane_to_scalar = lane_to_scalar,
                                              .scalar_to_lane = scalar_to_lane,
                                              .forget = forget,
                                              .is_sound = is_sound};
