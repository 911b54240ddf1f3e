/* verlet_batch.c - steps of Stormer-Verlet of several members of an ensemble at once, as in verlet.c: lane m of a sweep
 * is member m. */
#include "method/list.h"
#include "method/single.h"

#include <math.h>
#include <string.h>

enum { MOST_WIDTH = 64, LEAST_WIDTH = 8, MOST_BYTES = 16 << 10 };

typedef struct {
    tvi_single by_itself;
    const tvi_system *system;
    int width;
    double h;
    double *x;              /* block of the force's values */
    double *before, *after; /* [n][width] forces at the ends of the step */
    double *dq, *dp;        /* [n][width] */
    bool is_outside[MOST_WIDTH];
} batch;

static int width_of(const tvi_system *system, const tvi_options *options)
{
    const int bytes = system->field_values->slots * (int)sizeof(double);
    int width = LEAST_WIDTH;
    (void)options;
    while (2 * width <= MOST_WIDTH && 2 * width * bytes <= MOST_BYTES) width *= 2;
    return width;
}

static void *take(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width)
{
    batch *taken = tvi_arena_take(arena, sizeof *taken);
    batch w = {.system = system, .width = width};
    tvi_single_take(&w.by_itself, arena, tvi_stormer_verlet.stepper, system, options, width, 1);
    w.x = tvi_arena_block(arena, system->field_values, 1, width, 0);
    double **const vectors[] = {&w.before, &w.after, &w.dq, &w.dp};
    for (size_t i = 0; i < 4; i++) *vectors[i] = tvi_arena_doubles(arena, (size_t)system->n * (size_t)width);
    if (taken) *taken = w;
    return taken;
}

static void prepare(void *work)
{
    batch *w = work;
    tvi_single_prepare(&w->by_itself);
}

/* out = F at the coordinates in w->x, at t + (t_low + later). */
static void kick(batch *w, const tvi_batch_origin *origin, double later, double *out)
{
    const jet_tape *tape = w->system->field_values;
    const int n = w->system->n, width = w->width;
    for (int m = 0; w->system->uses_time && m < width; m++)
        w->x[n * width + m] = origin->t[m] + (origin->t_low[m] + later);
    if (!tape->sweeps->values(tape, w->x, width))
        for (int m = 0; m < width; m++) w->is_outside[m] |= !tvi_single_is_inside(&w->by_itself, tape, w->x, 1, m);
    for (int i = 0; i < n; i++) memcpy(out + i * width, w->x + tape->output[i] * width, (size_t)width * sizeof *out);
}

static void move(batch *w, double h, const tvi_batch_origin *origin)
{
    const int n = w->system->n, width = w->width;
    memset(w->is_outside, 0, sizeof w->is_outside);
    memcpy(w->x, origin->q, (size_t)(n * width) * sizeof *w->x);
    kick(w, origin, 0, w->before);
    for (int i = 0; i < n; i++) {
        const double factor = h / w->system->mass[i];
        for (int at = i * width; at < (i + 1) * width; at++) {
            w->dq[at] = factor * (origin->p[at] + (origin->p_low[at] + h / 2 * w->before[at]));
            w->x[at] = origin->q[at] + (origin->q_low[at] + w->dq[at]);
        }
    }
    kick(w, origin, h, w->after);
    for (int at = 0; at < n * width; at++) w->dp[at] = h / 2 * (w->before[at] + w->after[at]);
    w->h = h;
}

static void step(void *work, double h, const tvi_batch_origin *origin, const tvi_batch_end *end, tvi_stats *stats)
{
    batch *w = work;
    const int n = w->system->n, width = w->width;
    move(w, h, origin);
    for (int m = 0; m < width; m++) {
        if (end->status[m] != TVI_OK) continue;
        end->tail[m] = 0;
        end->passes[m] = 0;
        if (w->is_outside[m]) {
            (void)tvi_single_step(&w->by_itself, w->system->field_values, w->x, 1, h, origin, end, m, stats);
            continue;
        }
        for (int at = m; at < n * width; at += width) {
            end->by.dq[at] = w->dq[at];
            end->by.dp[at] = w->dp[at];
        }
        stats->force_evaluations += 2;
    }
}

/* There is no history. */
/* As in verlet.c. */
static void most_change(const void *work, double change[])
{
    const batch *w = work;
    const int width = w->width;
    memset(change, 0, (size_t)width * sizeof *change);
    for (int i = 0; i < w->system->n; i++) {
        const double factor = w->h / w->system->mass[i];
        for (int m = 0, at = i * width; m < width; m++, at++)
            change[m] += fabs(w->after[at] - w->before[at]) * (fabs(w->dq[at]) + fabs(factor * w->dp[at])) / 2;
    }
}

const tvi_batch_stepper tvi_verlet_batch = {
    .width = width_of, .take = take, .prepare = prepare, .step = step, .most_change = most_change};
