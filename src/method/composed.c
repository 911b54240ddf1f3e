/* composed.c - Makes a step as half a step of a method and half a step of its adjoint, which is symmetric for every
 * method. */
#include "method/method.h"
#include "method/stepper.h"

#include <math.h>
#include <string.h>

typedef struct {
    int n;
    tvi_options options[2]; /* the method and its adjoint */
    const tvi_stepper *stepper[2];
    void *work[2];
    /* [n] the state between the halves. */
    double *q, *q_low, *p, *p_low;
    tvi_increments half; /* of the first half */
} composed;

static void *take(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    composed *taken = tvi_arena_take(arena, sizeof *taken);
    composed c = {.n = system->n, .options = {*options, tvi_method_adjoint(options)}};
    double **const vectors[] = {&c.q, &c.q_low, &c.p, &c.p_low, &c.half.dq, &c.half.dp, &c.half.dq_low, &c.half.dp_low};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        *vectors[i] = tvi_arena_doubles(arena, (size_t)system->n);
    for (int half = 0; half < 2; half++) {
        c.options[half].compose_adjoint = false;
        if (taken) taken->options[half] = c.options[half]; /* the halves refer to them */
        c.stepper[half] = tvi_method_stepper(&c.options[half]);
        c.work[half] = c.stepper[half]->take(arena, system, taken ? &taken->options[half] : &c.options[half]);
    }
    if (taken) *taken = c;
    return taken;
}

static void prepare(void *work)
{
    composed *c = work;
    for (int half = 0; half < 2; half++) c->stepper[half]->prepare(c->work[half]); /* tables of the halves */
}

/* Computes (sum, low) = (x, x_low) + (d, d_low). */
static void add(int n, const double x[], const double x_low[], const double d[], const double d_low[], double sum[],
                double low[])
{
    for (int i = 0; i < n; i++) {
        low[i] = x_low[i];
        sum[i] = tvi_add_compensated(x[i], &low[i], d[i], d_low[i]);
    }
}

static tvi_status step(void *work, double h, const tvi_origin *origin, const tvi_increments *increments,
                       tvi_stats *stats)
{
    composed *c = work;
    const tvi_increments *half = &c->half;
    const int n = c->n;
    tvi_status status = c->stepper[0]->step(c->work[0], h / 2, origin, half, stats);
    if (status != TVI_OK) return status;
    const double first_tail = stats->tail;
    add(n, origin->q, origin->q_low, half->dq, half->dq_low, c->q, c->q_low);
    add(n, origin->p, origin->p_low, half->dp, half->dp_low, c->p, c->p_low);
    tvi_origin middle = {origin->t, origin->t_low, c->q, c->q_low, c->p, c->p_low};
    middle.t = tvi_add_compensated(middle.t, &middle.t_low, h / 2, 0);
    status = c->stepper[1]->step(c->work[1], h / 2, &middle, increments, stats);
    stats->tail = fmax(stats->tail, first_tail);
    add(n, increments->dq, increments->dq_low, half->dq, half->dq_low, increments->dq, increments->dq_low);
    add(n, increments->dp, increments->dp_low, half->dp, half->dp_low, increments->dp, increments->dp_low);
    return status;
}

static void dense(void *work, double theta, double dq[], double dp[])
{
    composed *c = work;
    const int half = theta > 0.5;
    c->stepper[half]->dense(c->work[half], 2 * theta - half, dq, dp);
    if (half == 0) return;
    for (int i = 0; i < c->n; i++) {
        dq[i] += c->half.dq[i];
        dp[i] += c->half.dp[i];
    }
}

/* The tapes that generated code needs for a half; its adjoint runs the same ones. */
static tvi_used_tapes uses(const tvi_system *system, const tvi_options *options)
{
    tvi_options half = *options;
    half.compose_adjoint = false;
    return tvi_method_stepper(&half)->uses(system, &half);
}

static bool is_sound(const void *work)
{
    const composed *c = work;
    for (int half = 0; half < 2; half++)
        if (c->stepper[half]->is_sound && !c->stepper[half]->is_sound(c->work[half])) return false;
    return true;
}

const tvi_stepper tvi_stepper_composed = {
    .take = take, .prepare = prepare, .step = step, .dense = dense, .is_sound = is_sound, .uses = uses};
