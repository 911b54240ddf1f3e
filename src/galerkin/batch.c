/* batch.c - steps of the Galerkin curves of several members of an ensemble at once. Lane i * width + m of a sweep is
 * node i of member m, so that all but the field is loops over members that need no sums across lanes (batch_loops.h).
 *
 * A member converges by passes of its own: one that has done so moves no more, while the others go on. Steps in lanes
 * are those that go on from two steps of the same size, and whose passes converge to a roundoff that is known. All
 * others, as the first two of a run, are made by the stepper of a single curve, one after the other; so whatever may
 * happen in a step is written once. */
#include "compiled/code.h"
#include "galerkin/batch_loops.h"
#include "galerkin/step.h"
#include "method/single.h"

enum { MOST_LANES = 256, LEAST_WIDTH = 8, MOST_WIDTH = 32 };
/* Of a block of the tape, partly in the second-level cache; a block of the least width may be larger, but where a whole
 * step is generated code, which then is faster. */
enum { MOST_BYTES = 40 << 10, MOST_BYTES_OF_ALL = 128 << 10 };

typedef struct {
    tvi_single by_itself;
    galerkin *single; /* its work, which has all tables */
    const galerkin_batch_loops *loops;
    galerkin_batch_nodes nodes;
    galerkin_batch_drift drift;
    galerkin_motion motion;
    galerkin_halves halves;
    tvi_passes_rule rule;
    bool are_all_in_lanes;
    int *slot;                    /* [unknowns] as of the field; or behind the tape's slots the copy of an output */
    int copies, *copied;          /* [copies] that is an input */
    tvi_increments by;            /* [n][width] each, */
    double *share, *ratio;        /* [n][width] */
    double *moved;                /* [width] */
    galerkin_batch_passes passes; /* [width] */
    galerkin_batch_history last;  /* in the history, as the impulses and where the last ones are */
    galerkin_pace *pace;          /* [width] likewise, of a step that a member made alone */
    int *turn;
    double *impulses[GALERKIN_TURNS]; /* [unknowns][points][width] of the last step, of the one before, of the next */
} batch;

/* ---- Memory and tables ------------------------------------------------------------------------------------------- */

static const galerkin_batch_loops *const loops_of[JET_ISA_COUNT] = {
    [jet_isa_base] = &tvi_galerkin_batch_loops_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = &tvi_galerkin_batch_loops_avx2,
    [jet_isa_avx512] = &tvi_galerkin_batch_loops_avx512,
#endif
};

static int width_of(const tvi_system *system, const tvi_options *options)
{
    const int points = options->degree, bytes = system->field_values->slots * points * (int)sizeof(double);
    if (!tvi_galerkin_is_plain(system) || options->passes == TVI_PREDICT_ONLY) return 1;
    const bool has_steps = system->code && system->code->galerkin;
    if (LEAST_WIDTH * bytes > (has_steps ? MOST_BYTES : MOST_BYTES_OF_ALL)) return 1;
    int width = LEAST_WIDTH;
    while (2 * width <= MOST_WIDTH && 2 * width * points <= MOST_LANES && 2 * width * bytes <= MOST_BYTES) width *= 2;
    return width;
}

static void take_nodes(galerkin_batch_nodes *nodes, tvi_arena *arena, const tvi_system *system, int points, int width)
{
    const size_t of_unknowns = (size_t)system->inputs * (size_t)width, numbers = of_unknowns * (size_t)points;
    nodes->width = width;
    nodes->points = points;
    nodes->unknowns = system->inputs;
    nodes->parts = system->parts;
    nodes->x = tvi_arena_block(arena, system->field_values, 1, points * width, numbers); /* and copies */
    nodes->start = tvi_arena_doubles(arena, of_unknowns);
    nodes->high = tvi_arena_doubles(arena, numbers);
    nodes->low = tvi_arena_doubles(arena, numbers);
    nodes->inverse_size = tvi_arena_doubles(arena, of_unknowns);
    nodes->is_moving = tvi_arena_take(arena, (size_t)width * sizeof *nodes->is_moving);
    nodes->in_lanes = tvi_arena_take(arena, (size_t)width * sizeof *nodes->in_lanes);
}

static void *take(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width)
{
    batch *taken = tvi_arena_take(arena, sizeof *taken);
    batch w = {.loops = loops_of[system->field_values->sweeps->isa]};
    tvi_single_take(&w.by_itself, arena, &tvi_stepper_galerkin, system, options, width, options->degree);
    w.single = w.by_itself.work;
    take_nodes(&w.nodes, arena, system, options->degree, width);
    const size_t count = (size_t)width, n = (size_t)system->n * count, unknowns = (size_t)system->inputs * count;
    galerkin_sums *sums = &w.motion.sums;
    double **const of_unknowns[] = {&sums->once,     &sums->twice,     &sums->last,   &sums->reach,
                                    &sums->once_low, &sums->twice_low, &w.drift.high, &w.drift.low};
    double **const of_n[] = {&w.by.dq, &w.by.dp, &w.by.dq_low, &w.by.dp_low, &w.share, &w.ratio};
    for (size_t i = 0; i < 8; i++) *of_unknowns[i] = tvi_arena_doubles(arena, unknowns);
    for (size_t i = 0; i < 6; i++) *of_n[i] = tvi_arena_doubles(arena, n);
    w.moved = tvi_arena_doubles(arena, count);
    w.slot = tvi_arena_take(arena, (size_t)system->inputs * sizeof *w.slot);
    w.copied = tvi_arena_take(arena, (size_t)system->inputs * sizeof *w.copied);
    galerkin_batch_passes *passes = &w.passes;
    double **const of_passes[] = {&passes->size,    &passes->before, &passes->part,
                                  &passes->slowest, &passes->shown,  &passes->count};
    for (size_t i = 0; i < 6; i++) *of_passes[i] = tvi_arena_doubles(arena, count);
    passes->is_stuck = tvi_arena_take(arena, count * sizeof *passes->is_stuck);
    double **const of_last[] = {&w.last.h, &w.last.h_before, &w.last.t, &w.last.slowest};
    for (size_t i = 0; i < 4; i++) *of_last[i] = tvi_arena_history(arena, count * sizeof(double));
    w.pace = tvi_arena_history(arena, count * sizeof *w.pace);
    w.turn = tvi_arena_history(arena, sizeof *w.turn);
    for (int i = 0; i < GALERKIN_TURNS; i++)
        w.impulses[i] = tvi_arena_history(arena, unknowns * (size_t)options->degree * sizeof(double));
    if (taken) *taken = w;
    return taken;
}

/* An output may be an input: then moving one unknown would change what drives another. */
static void find_drives(batch *w)
{
    const tvi_system *system = w->single->field.system;
    w->copies = 0;
    for (int u = 0; u < w->nodes.unknowns; u++) {
        const int slot = w->slot[u] = w->single->field.slot[u];
        if (slot >= system->inputs) continue;
        w->slot[u] = system->field_values->slots + w->copies;
        w->copied[w->copies++] = slot;
    }
}

static void prepare(void *work)
{
    batch *w = work;
    galerkin *single = w->single;
    galerkin_batch_nodes *nodes = &w->nodes;
    tvi_single_prepare(&w->by_itself);
    nodes->stride = single->field.nodes.lanes;
    nodes->weight = single->field.nodes.weight;
    nodes->scale = single->field.nodes.scale;
    nodes->per_movement = single->field.nodes.per_movement;
    const galerkin_sums sums = w->motion.sums;
    w->motion = single->motion;
    w->motion.sums = sums;
    find_drives(w);
    tvi_galerkin_halves_prepare(&w->halves, &single->coefficients, galerkin_is_second_order(&single->field));
    w->rule = tvi_galerkin_rule(single->field.form->rule, nodes->unknowns * nodes->points, single->options);
}

/* ---- Members one by one ------------------------------------------------------------------------------------------ */

/* As tvi_galerkin_impulses. */
static double *impulses(const batch *w, int after_last)
{
    return w->impulses[(*w->turn + after_last + GALERKIN_TURNS) % GALERKIN_TURNS];
}

/* Between [unknowns][points][width] and [unknowns][lanes]. */
static void gather_impulses(const batch *w, const double *from, int m, double *to)
{
    const galerkin_batch_nodes *nodes = &w->nodes;
    for (int u = 0; u < nodes->unknowns; u++)
        tvi_gather(nodes->points, nodes->width, from + u * nodes->points * nodes->width, m, to + u * nodes->stride);
}

static void scatter_impulses(const batch *w, const double *from, int m, double *to)
{
    const galerkin_batch_nodes *nodes = &w->nodes;
    for (int u = 0; u < nodes->unknowns; u++)
        tvi_scatter(nodes->points, nodes->width, from + u * nodes->stride, m, to + u * nodes->points * nodes->width);
}

/* The history of a lane, as the single stepper has it. Lanes are predicted from two steps, however rough that is: so
 * how far the first movement went is not kept. */
static void get(const void *work, int lane, void *one)
{
    const batch *w = work;
    const galerkin_predictor *predictor = &((galerkin *)one)->predictor;
    const galerkin_batch_history *last = &w->last;
    *predictor->last = (galerkin_history){
        .h = last->h[lane], .h_before = last->h_before[lane], .t = last->t[lane], .pace = w->pace[lane]};
    for (int i = 0; i < 2; i++) gather_impulses(w, impulses(w, -i), lane, tvi_galerkin_impulses(predictor, -i));
}

static void put(void *work, int lane, const void *one)
{
    const batch *w = work;
    const galerkin_predictor *predictor = &((const galerkin *)one)->predictor;
    w->last.h[lane] = predictor->last->h;
    w->last.h_before[lane] = predictor->last->h_before;
    w->last.t[lane] = predictor->last->t;
    w->pace[lane] = predictor->last->pace;
    w->last.slowest[lane] = w->pace[lane].slowest;
    for (int i = 0; i < 2; i++) scatter_impulses(w, tvi_galerkin_impulses(predictor, -i), lane, impulses(w, -i));
}

static void forget(void *work, int lane)
{
    const batch *w = work;
    w->last.h[lane] = w->last.h_before[lane] = w->last.t[lane] = w->last.slowest[lane] = 0;
    w->pace[lane] = (galerkin_pace){0};
}

static bool is_sound(const void *work)
{
    const int turn = *((const batch *)work)->turn;
    return turn >= 0 && turn < GALERKIN_TURNS;
}

static void step_by_itself(batch *w, double h, const tvi_batch_origin *origin, const tvi_batch_end *end, int m,
                           tvi_stats *stats)
{
    const jet_tape *tape = w->single->field.system->field_values;
    get(w, m, w->single);
    if (tvi_single_step(&w->by_itself, tape, w->nodes.x, w->nodes.points, h, origin, end, m, stats))
        put(w, m, w->single);
}

/* ---- The start of a step ----------------------------------------------------------------------------------------- */

/* What goes by itself rests where it starts, so that it does not disturb the sweeps. */
static void rest(const batch *w, int m)
{
    const galerkin_batch_nodes *nodes = &w->nodes;
    nodes->is_moving[m] = 0;
    for (int at = m; at < nodes->unknowns * nodes->points * nodes->width; at += nodes->width) {
        nodes->impulse[at] = nodes->low[at] = 0;
        nodes->high[at] = nodes->start[at / (nodes->points * nodes->width) * nodes->width + m];
    }
}

static void set_start(batch *w, const tvi_batch_origin *origin)
{
    const galerkin_batch_nodes *nodes = &w->nodes;
    if (galerkin_is_second_order(&w->single->field)) {
        w->loops->start_drifting(nodes, w->single->coefficients.c, origin, &w->drift);
    } else {
        w->loops->start(nodes, 0, w->single->n, origin->q, origin->q_low);
        w->loops->start(nodes, w->single->n, w->single->n, origin->p, origin->p_low);
    }
}

static void set_times(const batch *w, double h, const tvi_batch_origin *origin)
{
    const galerkin_batch_nodes *nodes = &w->nodes;
    double *t = nodes->x + nodes->unknowns * nodes->points * nodes->width;
    if (!w->single->field.system->uses_time) return;
    for (int i = 0; i < nodes->points; i++)
        for (int m = 0; m < nodes->width; m++)
            *t++ = origin->t[m] + (origin->t_low[m] + h * w->single->coefficients.c[i]);
}

static void predict(batch *w, double h, const tvi_batch_origin *origin)
{
    set_start(w, origin);
    for (int m = 0; m < w->nodes.width && !w->are_all_in_lanes; m++)
        if (!w->nodes.in_lanes[m]) rest(w, m);
    w->loops->predict(&w->nodes, w->single->predictor.extrapolation[GALERKIN_FROM_TWO], impulses(w, 0),
                      impulses(w, -1));
    set_times(w, h, origin);
    w->loops->set_sizes(&w->nodes, w->single->n);
}

/* ---- Passes ------------------------------------------------------------------------------------------------------ */

/* Members that are outside of the domain, or whose passes are stuck, go by themselves. */
static void leave(batch *w, int m)
{
    w->nodes.in_lanes[m] = 0;
    w->are_all_in_lanes = false;
    rest(w, m);
}

static void copy_inputs(const batch *w, int slots)
{
    const size_t count = (size_t)(w->nodes.points * w->nodes.width);
    double *x = w->nodes.x, *copy = x + (size_t)slots * count;
    for (int i = 0; i < w->copies; i++, copy += count)
        memcpy(copy, x + (size_t)w->copied[i] * count, count * sizeof *x);
}

static void pass(batch *w, int count, tvi_stats *stats)
{
    const galerkin_batch_nodes *nodes = &w->nodes;
    const jet_tape *tape = w->single->field.system->field_values;
    const bool inside = tape->sweeps->values(tape, nodes->x, nodes->points * nodes->width);
    stats->force_evaluations += count * nodes->points;
    stats->passes += count;
    for (int m = 0; m < nodes->width && !inside; m++)
        if (nodes->is_moving[m] && !tvi_single_is_inside(&w->by_itself, tape, nodes->x, nodes->points, m)) leave(w, m);
    copy_inputs(w, tape->slots);
    w->loops->move(nodes, &w->halves, nodes->x, w->slot, w->moved);
}

static void iterate(batch *w, int count, tvi_stats *stats)
{
    bool any_stuck;
    for (int passes = 1; count > 0 && passes <= w->rule.most; passes++) {
        w->nodes.is_first = passes == 1;
        pass(w, count, stats);
        count = w->loops->judge(&w->nodes, &w->rule, passes, w->moved, &w->passes, &any_stuck);
        for (int m = 0; m < w->nodes.width && any_stuck; m++)
            if (w->nodes.in_lanes[m] && w->passes.is_stuck[m]) leave(w, m);
    }
    for (int m = 0; m < w->nodes.width && count > 0; m++)
        if (w->nodes.is_moving[m]) leave(w, m);
}

/* ---- The end of a step ------------------------------------------------------------------------------------------- */

/* Of all members. */
static tvi_increments integrate(const batch *w)
{
    const galerkin_sums *sums = &w->motion.sums;
    const galerkin_batch_nodes *nodes = &w->nodes;
    const int n = w->single->n, momenta = n * nodes->width;
    tvi_increments by = w->by;
    w->loops->integrate(nodes, &w->single->coefficients.weights, sums);
    if (galerkin_is_second_order(&w->single->field)) {
        w->loops->end_drifting(nodes, sums, &w->drift, by.dq, by.dq_low);
        by.dp = sums->once;
        by.dp_low = sums->once_low;
    } else {
        w->loops->end(nodes, 0, n, sums->once, by.dq);
        w->loops->end(nodes, 0, n, sums->once_low, by.dq_low);
        w->loops->end(nodes, n, n, sums->once + momenta, by.dp);
        w->loops->end(nodes, n, n, sums->once_low + momenta, by.dp_low);
    }
    return by;
}

/* What goes by itself, or not at all, has the impulses that it had. */
static void remember(const batch *w)
{
    const int width = w->nodes.width, rows = w->nodes.unknowns * w->nodes.points;
    double *const before = impulses(w, -1), *const last = impulses(w, 0), *const next = impulses(w, 1);
    for (int m = 0; m < width && !w->are_all_in_lanes; m++)
        for (int at = m; at < rows * width && !w->nodes.in_lanes[m]; at += width) {
            next[at] = last[at];
            last[at] = before[at];
        }
    *w->turn = (*w->turn + 1) % GALERKIN_TURNS;
}

/* Of those that are solved in lanes. */
static void finish(batch *w, const tvi_batch_origin *origin, const tvi_batch_end *end)
{
    const galerkin_batch_nodes *nodes = &w->nodes;
    const int n = w->single->n;
    const tvi_increments by = integrate(w);
    w->motion.q = origin->q;
    w->motion.p = origin->p;
    w->motion.dp = by.dp;
    remember(w);
    w->loops->choose(nodes, n, by.dq, end->by.dq);
    w->loops->choose(nodes, n, by.dp, end->by.dp);
    w->loops->choose(nodes, n, by.dq_low, end->by.dq_low);
    w->loops->choose(nodes, n, by.dp_low, end->by.dp_low);
    w->loops->tail(&w->motion, nodes->width, w->share, w->ratio, w->moved);
    w->loops->choose(nodes, 1, w->moved, end->tail);
    w->loops->choose(nodes, 1, origin->t, w->last.t);
    w->loops->choose(nodes, 1, w->passes.slowest, w->last.slowest);
    for (int m = 0; m < nodes->width; m++) w->pace[m] = (galerkin_pace){.slowest = w->last.slowest[m]};
    for (int m = 0; m < nodes->width; m++)
        end->passes[m] = nodes->in_lanes[m] ? (int)w->passes.count[m] : end->passes[m];
}

static void step(void *work, double h, const tvi_batch_origin *origin, const tvi_batch_end *end, tvi_stats *stats)
{
    batch *w = work;
    tvi_galerkin_set_size(w->single, h);
    w->nodes.impulse = impulses(w, 1);
    const int count = w->loops->begin(&w->nodes, &w->last, h, origin->t, end->status, &w->passes);
    w->are_all_in_lanes = count == w->nodes.width;
    if (count > 0) {
        predict(w, h, origin);
        iterate(w, count, stats);
        finish(w, origin, end);
    }
    for (int m = 0; m < w->nodes.width && !w->are_all_in_lanes; m++)
        if (end->status[m] == TVI_OK && !w->nodes.in_lanes[m]) step_by_itself(w, h, origin, end, m, stats);
}

const tvi_batch_stepper tvi_galerkin_batch = {.width = width_of,
                                              .take = take,
                                              .prepare = prepare,
                                              .step = step,
                                              .get = get,
                                              .put = put,
                                              .forget = forget,
                                              .is_sound = is_sound};
