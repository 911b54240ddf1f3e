/* run.c - Makes one measured run (run.h). */
#include "run.h"

#include <math.h>
#include <string.h>
#include <time.h>

/* Repetitions of the timing: three and 10 ms at least, unless they are long. */
static const int repetitions = 3;
static const double shortest = 0.01, longest = 0.1;
/* Turns of a pair: seven and 30 ms at least, or three where they are long. */
static const int turns = 7, least_turns = 3;
static const double shortest_pair = 0.03, longest_pair = 0.4;
/* The runs timed at once: a run, or as many as take this long, beside which reading the clock takes nothing. */
static const double shortest_timing = 1e-4;

const double run_before_timing = 3e-3;

double run_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- A run, whoever runs ----------------------------------------------------------------------------------------- */

tvi_status runner_open(runner *r, const tvi_system *system, const scene *s, const contender *who, double setting)
{
    const bool adaptive = who->baseline && who->baseline->adaptive;
    *r = (runner){.scene = s, .baseline = who->baseline, .h = setting};
    if (adaptive) r->h = s->t_end, r->tolerance = setting;
    r->steps = lround(s->t_end / r->h);
    return r->baseline ? TVI_OK : tvi_integrator_create(&r->integrator, system, &who->options);
}

void runner_close(runner *r) { tvi_integrator_free(r->integrator); }

static tvi_status go_integrator(runner *r, double q[], double p[], tvi_observer *observer, void *ctx)
{
    const tvi_stats *now = tvi_integrator_stats(r->integrator), before = *now;
    double t = 0;
    tvi_integrator_reset(r->integrator);
    const tvi_status status = tvi_integrate(r->integrator, r->h, r->steps, &t, q, p, observer, ctx);
    r->counts = (baseline_counts){.steps = now->steps - before.steps,
                                  .force_evaluations = now->force_evaluations - before.force_evaluations,
                                  .passes = now->passes - before.passes};
    return status;
}

tvi_status runner_go(runner *r, double q[], double p[], tvi_observer *observer, void *ctx)
{
    const scene *s = r->scene;
    memcpy(q, s->q, (size_t)s->n * sizeof *q);
    memcpy(p, s->p, (size_t)s->n * sizeof *p);
    if (!r->baseline) return go_integrator(r, q, p, observer, ctx);
    const baseline_task task = {s, r->h, r->steps, r->tolerance, observer, ctx};
    return r->baseline->run(r->baseline, &task, q, p, &r->counts);
}

/* CPU time of so many runs; infinite where one fails. */
static double time_runs(runner *r, long count)
{
    double q[r->scene->n], p[r->scene->n];
    tvi_status status = TVI_OK;
    const double begin = run_clock();
    for (long i = 0; i < count && status == TVI_OK; i++) status = runner_go(r, q, p, NULL, NULL);
    return status == TVI_OK ? run_clock() - begin : INFINITY;
}

/* CPU time of one run, of as many as are timed at once; infinite where one fails. Adds all that it took to the total.
 * Before a run that is long none is needed that is not timed. */
static double time_once(runner *r, double *total)
{
    const double begin = run_clock();
    double once = time_runs(r, 1);
    if (once < 10 * run_before_timing) {
        while (run_clock() - begin < run_before_timing) (void)time_runs(r, 1);
        if (r->at_once == 0) r->at_once = 1;
        double all;
        while ((all = time_runs(r, r->at_once)) < shortest_timing) r->at_once *= 2;
        once = all / (double)r->at_once;
    }
    *total += run_clock() - begin;
    return once;
}

/* ---- Errors ------------------------------------------------------------------------------------------------------ */

typedef struct {
    const tvi_system *system;
    long steps, every; /* every this many steps, and after the last one */
    double start, scale, worst;
    double deadline; /* of run_clock */
} monitor;

/* worst = max |H - H0| / scale; infinite from the first H that has no value on. */
static int watch(long step, double t, const double q[], const double p[], void *ctx)
{
    monitor *m = ctx;
    if (m->deadline < INFINITY && run_clock() > m->deadline) return 1;
    if (step % m->every != 0 && step != m->steps) return 0;
    double energy, error = INFINITY;
    if (tvi_energy(m->system, t, q, p, &energy) == TVI_OK) error = fabs(energy - m->start) / m->scale;
    m->worst = error <= m->worst ? m->worst : isnan(error) ? INFINITY : error;
    return 0;
}

static void compare_with_reference(const scene *s, const double q[], const double p[], run *result)
{
    double largest = 0, squares = 0;
    for (int i = 0; i < s->n; i++) {
        double dq = q[i] - s->reference[i], dp = p[i] - s->reference[s->n + i];
        largest = fmax(largest, fmax(fabs(dq), fabs(dp)));
        squares += dq * dq;
    }
    result->end_error = largest;
    result->position_error = sqrt(squares);
}

static void measure_errors(const tvi_system *system, runner *r, double deadline, run *result)
{
    const scene *s = r->scene;
    double q[s->n], p[s->n];
    monitor m = {.system = system, .steps = r->steps, .deadline = deadline};
    m.every = m.steps < RUN_SAMPLES ? 1 : m.steps / RUN_SAMPLES;
    result->status = tvi_energy(system, 0, s->q, s->p, &m.start);
    if (result->status != TVI_OK) return;
    m.scale = fmax(fabs(m.start), s->energy_scale);
    result->status = runner_go(r, q, p, watch, &m);
    if (result->status != TVI_OK && r->integrator) result->failed_step = r->counts.steps + 1;
    if (result->status != TVI_OK) return;
    result->steps = r->counts.steps;
    result->h = s->t_end / (double)result->steps;
    result->energy_error = m.worst;
    result->force_evaluations = r->counts.force_evaluations;
    result->passes_per_step = (double)r->counts.passes / (double)result->steps;
    compare_with_reference(s, q, p, result);
}

/* ---- Time -------------------------------------------------------------------------------------------------------- */

double runner_time(runner *r)
{
    double total = 0, best = INFINITY;
    for (int done = 0; total < longest && (done < repetitions || total < shortest); done++)
        best = fmin(best, time_once(r, &total));
    return best;
}

void run_contender(const tvi_system *system, const scene *s, const contender *who, double setting, double deadline,
                   run *result)
{
    runner r;
    const double begin = run_clock();
    *result = (run){.scene = s, .who = who, .method = who->name, .order = who->order, .setting = setting};
    result->status = runner_open(&r, system, s, who, setting);
    if (result->status != TVI_OK) return;
    result->h = r.h;
    result->steps = r.steps;
    if (r.integrator) result->degree = tvi_integrator_options(r.integrator)->degree;
    measure_errors(system, &r, deadline, result);
    if (result->status == TVI_OK) result->cpu = runner_time(&r);
    runner_close(&r);
    result->whole = run_clock() - begin;
}

void run_measure(const tvi_system *system, const scene *s, const tvi_options *options, double h, run *result)
{
    const contender who = {.order = options->order, .options = *options};
    run_contender(system, s, &who, h, INFINITY, result);
    result->who = NULL;
}

void run_in_turns(const tvi_system *system, const run *a, const run *b, double cpu[2])
{
    const run *const runs[2] = {a, b};
    runner r[2] = {0};
    double total = 0;
    for (int i = 0; i < 2; i++) cpu[i] = INFINITY;
    bool good = true;
    for (int i = 0; i < 2; i++) good &= runner_open(&r[i], system, a->scene, runs[i]->who, runs[i]->setting) == TVI_OK;
    for (int turn = 0;
         good && (turn < least_turns || (total < longest_pair && (turn < turns || total < shortest_pair))); turn++)
        for (int i = 0; i < 2; i++) cpu[i] = fmin(cpu[i], time_once(&r[i], &total));
    for (int i = 0; i < 2; i++) runner_close(&r[i]);
}
