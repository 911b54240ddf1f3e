/* taylor_batch.c - makes steps of the plain Taylor method of several members of an ensemble at once: lane m of a sweep
 * is member m. A member whose curve cannot be expanded makes its step by itself, and fails as a single step does. */
#include "generating/curve_stepper.h"
#include "generating/taylor_loops.h"
#include "method/single.h"

#include <math.h>
#include <string.h>

enum { MOST_WIDTH = 32, LEAST_WIDTH = 8 };
/* These bound a block of the series, which is to stay in the first-level cache; a block of the least width may be
 * larger. */
enum { MOST_BYTES = 30 << 10, MOST_BYTES_OF_ALL = 256 << 10 };

typedef struct {
    tvi_single by_itself;
    const tvi_system *system;
    const tvi_taylor_loops *loops;
    int degree;
    tvi_taylor_lanes curve;
    double *kappa;                    /* [n] */
    double *share, *ratio, *tail;     /* [n][width] scratch, and the tails [width] */
    tvi_taylor_sums sums;             /* [n][width] each; the increments are rise and slope */
    double power[TVI_MAX_DEGREE + 2]; /* the powers of the unit of time, which stays: 1 */
    double *chosen;                   /* [width] `chosen` of curve_stepper.h, in the history */
} batch;

static const tvi_taylor_loops *const loops_of[JET_ISA_COUNT] = {
    [jet_isa_base] = &tvi_taylor_loops_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = &tvi_taylor_loops_avx2,
    [jet_isa_avx512] = &tvi_taylor_loops_avx512,
#endif
};

const tvi_taylor_loops *tvi_taylor_loops_of(const tvi_system *system)
{
    return loops_of[system->field_series->sweeps->isa];
}

static int width_of(const tvi_system *system, const tvi_options *options)
{
    const int bytes = system->field_series->slots * (options->degree + 1) * (int)sizeof(double);
    int width = LEAST_WIDTH;
    if (system->form == TVI_LAGRANGIAN || LEAST_WIDTH * bytes > MOST_BYTES_OF_ALL) return 1;
    while (2 * width <= MOST_WIDTH && 2 * width * bytes <= MOST_BYTES) width *= 2;
    return width;
}

static void *take(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width)
{
    batch *taken = tvi_arena_take(arena, sizeof *taken);
    const jet_tape *tape = system->field_series;
    const size_t n = (size_t)system->n;
    batch w = {.system = system, .loops = tvi_taylor_loops_of(system), .degree = options->degree};
    tvi_single_take(&w.by_itself, arena, &tvi_stepper_taylor, system, options, width, 1);
    double **const of_n[] = {&w.share, &w.ratio, &w.tail, &w.sums.rise, &w.sums.size, &w.sums.slope, &w.sums.bend};
    for (size_t i = 0; i < 7; i++) *of_n[i] = tvi_arena_doubles(arena, n * (size_t)width);
    w.kappa = tvi_arena_doubles(arena, n);
    w.chosen = tvi_arena_history(arena, (size_t)width * sizeof *w.chosen);
    w.curve = (tvi_taylor_lanes){.n = system->n,
                                 .width = width,
                                 .top = options->degree,
                                 .stride = (size_t)tape->slots * (size_t)width,
                                 .kappa = w.kappa,
                                 .output = tape->output,
                                 .x = tvi_arena_block(arena, tape, options->degree + 1, width, 0),
                                 .has_masses = system->form == TVI_SEPARABLE,
                                 .system = system};
    if (taken) *taken = w;
    return taken;
}

static void prepare(void *work)
{
    batch *w = work;
    tvi_single_prepare(&w->by_itself);
    for (int k = 0; k <= w->degree; k++) w->power[k] = 1;
}

/* Sets the data at the start: (q, tau v) or (q, p). */
static void set_start(batch *w, double h, const tvi_batch_origin *origin)
{
    tvi_taylor_lanes *curve = &w->curve;
    const int width = curve->width;
    const size_t numbers = (size_t)curve->n * (size_t)width;
    double *second = curve->has_masses ? curve->x + curve->stride : curve->x + numbers;
    curve->tau = h;
    memcpy(curve->x, origin->q, numbers * sizeof *curve->x);
    for (int i = 0; i < curve->n; i++) {
        w->kappa[i] = curve->has_masses ? h / w->system->mass[i] : 1;
        for (int at = i * width; at < (i + 1) * width; at++) second[at] = w->kappa[i] * origin->p[at];
    }
    double *time = curve->x + w->system->inputs * width;
    for (int m = 0; w->system->uses_time && m < width; m++) {
        time[m] = origin->t[m] + origin->t_low[m];
        time[curve->stride + (size_t)m] = h;
    }
}

/* Ends the steps as curve_end_at of reach.h does. */
static void end_at(batch *w)
{
    const tvi_taylor_lanes *curve = &w->curve;
    const tvi_taylor_sums *sums = &w->sums, of_p = {sums->slope, sums->bend, NULL, NULL};
    const int numbers = curve->n * curve->width, degree = w->degree;
    double *const x = curve->x;
    if (curve->has_masses) {
        w->loops->sweep(&(tvi_taylor_rows){numbers, 2, degree, curve->stride, true}, w->power, x, sums);
        for (int at = 0; at < numbers; at++) sums->slope[at] /= w->kappa[at / curve->width];
        return;
    }
    w->loops->sweep(&(tvi_taylor_rows){numbers, 1, degree, curve->stride, false}, w->power, x, sums);
    w->loops->sweep(&(tvi_taylor_rows){numbers, 1, degree - 1, curve->stride, false}, w->power, x + numbers, &of_p);
    for (int at = 0; at < numbers; at++) sums->bend[at] += fabs(x[numbers + at]);
}

static bool is_finite(const batch *w, int m)
{
    for (int at = m; at < w->curve.n * w->curve.width; at += w->curve.width)
        if (!isfinite(w->sums.rise[at]) || !isfinite(w->sums.slope[at])) return false;
    return true;
}

static void step(void *work, double h, const tvi_batch_origin *origin, const tvi_batch_end *end, tvi_stats *stats)
{
    batch *w = work;
    const tvi_taylor_lanes *curve = &w->curve;
    const jet_tape *tape = w->system->field_series;
    const int n = curve->n, width = curve->width, p_degree = w->degree - 1;
    set_start(w, h, origin);
    const bool inside = tvi_taylor_expand(w->loops, curve, tape);
    end_at(w);
    if (p_degree > 1) w->loops->tail(curve, w->degree, p_degree, &w->sums, w->share, w->ratio, w->tail);
    for (int m = 0; m < width; m++) {
        if (end->status[m] != TVI_OK) continue;
        if ((!inside && !tvi_single_is_inside(&w->by_itself, tape, curve->x, 1, m)) || !is_finite(w, m)) {
            (void)tvi_single_step(&w->by_itself, tape, curve->x, 1, h, origin, end, m, stats);
            continue;
        }
        for (int at = m; at < n * width; at += width) {
            end->increments.dq[at] = w->sums.rise[at];
            end->increments.dp[at] = w->sums.slope[at];
        }
        end->tail[m] = stats->tail = w->tail[m];
        end->passes[m] = 0;
        stats->expansions++;
    }
}

/* Copies what a member keeps. Steps of a given size leave nothing to the next one. A step to a tolerance leaves its
 * size, from which the member continues in later runs. */
static void get(const void *work, int lane, void *one)
{
    *((tvi_curve_work *)one)->chosen = ((const batch *)work)->chosen[lane];
}

static void put(void *work, int lane, const void *one)
{
    ((batch *)work)->chosen[lane] = *((const tvi_curve_work *)one)->chosen;
}

const tvi_batch_stepper tvi_taylor_batch = {
    .width = width_of, .take = take, .prepare = prepare, .step = step, .lane_to_scalar = get, .scalar_to_lane = put};
