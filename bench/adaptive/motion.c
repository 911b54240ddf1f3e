/* motion.c - Makes the runs of the lines of docs/adaptive.md. */
#include "adaptive.h"

#include <math.h>
#include <string.h>

enum { UNIT_REPETITIONS = 40 };

adaptive_motion adaptive_begin(const adaptive_line *l)
{
    const scene *s = &l->problem->scene;
    adaptive_motion r = {.system = experiment_system(s)};
    tvi_options options;
    experiment_insist(tvi_options_named(l->method, l->order, &options), l->method);
    if (l->g == ADAPTIVE_OWN || l->g == ADAPTIVE_AUTOMATIC)
        experiment_insist(
            tvi_system_rescaled(&r.rescaled, r.system, l->g == ADAPTIVE_OWN ? l->problem->scale : NULL, NULL), s->name);
    experiment_insist(tvi_integrator_create(&r.integrator, r.rescaled ? r.rescaled : r.system, &options), l->method);
    memcpy(r.q, s->q, (size_t)s->n * sizeof *r.q);
    memcpy(r.p, s->p, (size_t)s->n * sizeof *r.p);
    return r;
}

void adaptive_end(adaptive_motion *r)
{
    tvi_integrator_free(r->integrator);
    tvi_system_free(r->rescaled);
    tvi_system_free(r->system);
}

tvi_status adaptive_go(adaptive_motion *r, const adaptive_line *l, double t_end, tvi_observer *observer, void *ctx)
{
    if (l->g == ADAPTIVE_TOLERANCE)
        return tvi_integrate_tolerance(r->integrator, l->h, t_end, &r->t, r->q, r->p, observer, ctx);
    return tvi_integrate_to(r->integrator, l->h, t_end, &r->t, r->q, r->p, observer, ctx);
}

double adaptive_energy_error(const adaptive_motion *r, const scene *s)
{
    double H0, H, later;
    experiment_insist(tvi_energy(r->system, 0, s->q, s->p, &H0), s->name);
    experiment_insist(tvi_energy(r->system, 1, s->q, s->p, &later), s->name);
    experiment_insist(tvi_energy(r->system, r->t, r->q, r->p, &H), s->name);
    return later == H0 ? fabs(H - H0) / s->energy_scale : NAN;
}

double adaptive_time_of(const adaptive_line *l, int repetitions)
{
    double fastest = INFINITY;
    for (int i = 0; i < repetitions; i++) {
        adaptive_motion r = adaptive_begin(l);
        const double before = run_clock();
        experiment_insist(adaptive_go(&r, l, l->problem->scene.t_end, NULL, NULL), l->method);
        fastest = fmin(fastest, run_clock() - before);
        adaptive_end(&r);
    }
    return fastest;
}

double adaptive_time_of_unit(void)
{
    const scene *s = &scene_kepler;
    const baseline *gauss = baseline_find("gauss", 16);
    const baseline_task task = {.scene = s, .h = 0.25, .steps = 1000};
    double fastest = INFINITY;
    for (int i = 0; i < UNIT_REPETITIONS; i++) {
        double q[] = {s->q[0], s->q[1]}, p[] = {s->p[0], s->p[1]};
        baseline_counts counts;
        const double before = run_clock();
        experiment_insist(gauss->run(gauss, &task, q, p, &counts), "gauss");
        fastest = fmin(fastest, run_clock() - before);
    }
    return fastest;
}
