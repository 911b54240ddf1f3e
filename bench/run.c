#include "run.h"

#include <math.h>
#include <string.h>
#include <time.h>

/* Repetitions of the timing: three and 20 ms at least, unless they are long. */
static const int repetitions = 3;
static const double shortest = 0.02, longest = 0.25;

double run_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool enough(int done, double total)
{
    return total >= longest || (done >= repetitions && total >= shortest);
}

static long count_steps(const scene *s, double h) { return lround(s->t_end / h); }

/* steps steps from the scene's start; q[n] and p[n] receive the end. */
static tvi_status go(tvi_integrator *integrator, const scene *s, double h, long steps, double q[], double p[],
                     tvi_observer *observer, void *ctx)
{
    double t = 0;
    memcpy(q, s->q, (size_t)s->n * sizeof *q);
    memcpy(p, s->p, (size_t)s->n * sizeof *p);
    tvi_integrator_reset(integrator);
    return tvi_integrate(integrator, h, steps, &t, q, p, observer, ctx);
}

/* CPU time of one such run; negative where it fails. */
static double time_once(tvi_integrator *integrator, const scene *s, double h, long steps)
{
    double q[s->n], p[s->n], begin = run_clock();
    tvi_status status = go(integrator, s, h, steps, q, p, NULL, NULL);
    return status == TVI_OK ? run_clock() - begin : -1;
}

typedef struct {
    const tvi_system *system;
    long steps, every; /* every this many steps, and after the last one */
    double start, scale, worst;
} monitor;

/* worst = max |H - H0| / scale; infinite from the first H that has no value on. */
static int watch(long step, double t, const double q[], const double p[], void *ctx)
{
    monitor *m = ctx;
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

/* The first run of an integrator, so that its statistics are those of the run. */
static void measure_errors(const tvi_system *system, tvi_integrator *integrator, run *result)
{
    const scene *s = result->scene;
    const tvi_stats *stats = tvi_integrator_stats(integrator);
    double q[s->n], p[s->n];
    monitor m = {.system = system, .steps = result->steps};
    m.every = m.steps < RUN_SAMPLES ? 1 : m.steps / RUN_SAMPLES;
    result->status = tvi_energy(system, 0, s->q, s->p, &m.start);
    if (result->status != TVI_OK) return;
    m.scale = fmax(fabs(m.start), s->energy_scale);
    result->status = go(integrator, s, result->h, m.steps, q, p, watch, &m);
    result->failed_step = result->status == TVI_OK ? 0 : stats->steps + 1;
    result->energy_error = m.worst;
    result->force_evaluations = stats->force_evaluations;
    result->passes_per_step = (double)stats->passes / (double)m.steps;
    compare_with_reference(s, q, p, result);
}

static void measure_time(tvi_integrator *integrator, run *result)
{
    double total = 0, best = INFINITY;
    for (int done = 0; !enough(done, total); done++) {
        double once = time_once(integrator, result->scene, result->h, result->steps);
        best = fmin(best, once);
        total += once;
    }
    result->cpu = best;
}

double run_predict(const tvi_system *system, const scene *s, const tvi_options *options, double h)
{
    enum { PILOT = 16 };
    tvi_integrator *integrator;
    long steps = count_steps(s, h), pilot = steps < PILOT ? steps : PILOT;
    if (tvi_integrator_create(&integrator, system, options) != TVI_OK) return 0;
    double cold = time_once(integrator, s, h, pilot), warm = time_once(integrator, s, h, pilot);
    tvi_integrator_free(integrator);
    if (cold < 0 || warm < 0) return 0;
    double once = fmin(cold, warm) / (double)pilot * (double)steps, total = once;
    for (int done = 0; !enough(done, total - once); done++) total += fmax(once, shortest / repetitions);
    return total;
}

void run_measure(const tvi_system *system, const scene *s, const tvi_options *options, double h, run *result)
{
    tvi_integrator *integrator;
    *result = (run){.scene = s, .order = options->order, .h = h, .steps = count_steps(s, h)};
    result->status = tvi_integrator_create(&integrator, system, options);
    if (result->status != TVI_OK) return;
    result->degree = tvi_integrator_options(integrator)->degree;
    measure_errors(system, integrator, result);
    if (result->status == TVI_OK) measure_time(integrator, result);
    tvi_integrator_free(integrator);
}
