/* hard_run.c - Runs a hard case until it fails or ends (hard_run.h). */
#include "hard_run.h"
#include "gauss_recorded.h"

#include <math.h>
#include <string.h>

enum { N_MOST = BASELINE_N_MAX };

typedef struct {
    const hard_case *problem;
    const tvi_system *system;
    double start, scale;
    hard_run *run;
} monitor;

/* An observer: stops where the energy error is above the bound. */
static int watch(long step, double t, const double q[], const double p[], void *ctx)
{
    const monitor *m = ctx;
    double energy, error = INFINITY;
    if (tvi_energy(m->system, t, q, p, &energy) == TVI_OK) error = fabs(energy - m->start) / m->scale;
    m->run->steps = step;
    m->run->energy_error = fmax(m->run->energy_error, isnan(error) ? INFINITY : error);
    return !(error <= m->problem->bound);
}

bool hard_options(const hard_method *m, tvi_options *options)
{
    /* the degree of a composition is that of a half, whose order may be odd and one less */
    if (tvi_options_named(m->name, m->order, options) != TVI_OK &&
        (!m->composed || tvi_options_named(m->name, m->order - 1, options) != TVI_OK))
        return false;
    options->compose_adjoint = options->compose_adjoint || m->composed;
    options->order = m->order;
    return true;
}

static tvi_status run_library(const hard_method *m, monitor *w, double h, long steps, double q[], double p[])
{
    tvi_options options;
    tvi_integrator *integrator;
    double t = 0;
    if (!hard_options(m, &options)) return TVI_EINVAL;
    tvi_status status = tvi_integrator_create(&integrator, w->system, &options);
    if (status != TVI_OK) return status;
    status = tvi_integrate(integrator, h, steps, &t, q, p, watch, w);
    const tvi_stats *stats = tvi_integrator_stats(integrator);
    w->run->passes = stats->steps > 0 ? (double)stats->passes / (double)stats->steps : NAN;
    tvi_integrator_free(integrator);
    return status;
}

static tvi_status run_gauss(const hard_method *m, monitor *w, double h, long steps, double q[], double p[])
{
    const baseline_task task = {.scene = &w->problem->scene, .h = h, .steps = steps, .observer = watch, .ctx = w};
    baseline_counts counts;
    const tvi_status status = gauss_recorded(w->system, m->order, &task, q, p, &counts);
    w->run->passes = w->run->steps > 0 ? (double)counts.passes / (double)w->run->steps : NAN;
    return status;
}

static double distance(int n, const double a[], const double b[])
{
    double largest = 0, size = 0;
    for (int i = 0; i < n; i++) {
        largest = fmax(largest, fabs(a[i] - b[i]));
        size = fmax(size, fabs(b[i]));
    }
    return largest / size;
}

hard_run hard_run_make(const hard_case *c, const tvi_system *system, const hard_method *m, long steps)
{
    const scene *s = &c->scene;
    hard_run run = {.h = s->t_end / (double)steps, .position_error = NAN};
    monitor w = {.problem = c, .system = system, .run = &run};
    double q[N_MOST], p[N_MOST];
    memcpy(q, s->q, (size_t)s->n * sizeof *q);
    memcpy(p, s->p, (size_t)s->n * sizeof *p);
    run.status = tvi_energy(system, 0, q, p, &w.start);
    if (run.status != TVI_OK) return run;
    w.scale = fmax(fabs(w.start), s->energy_scale);
    run.status = (strcmp(m->name, "gauss") == 0 ? run_gauss : run_library)(m, &w, run.h, steps, q, p);
    if (run.status == TVI_OK && c->period > 0) run.position_error = distance(s->n, q, s->q);
    return run;
}

bool hard_run_survives(const hard_run *run) { return run->status == TVI_OK; }

const char *hard_run_cause(const hard_run *run)
{
#define NAME(code, text) #code,
    static const char *const names[] = {TVI_STATUS_LIST(NAME)};
#undef NAME
    return run->status == TVI_OK ? "-" : run->status == TVI_ESTOPPED ? "energy" : names[run->status];
}
