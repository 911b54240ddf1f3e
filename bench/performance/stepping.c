/* stepping.c - Makes steps of a system for timing (stepping.h). */
#include "stepping.h"

#include "experiments/experiment.h"

#include <string.h>

stepping stepping_open(const tvi_system *system, const tvi_options *options, const double q[], const double p[],
                       double h)
{
    stepping s = {.n = tvi_system_dimension(system), .q = q, .p = p, .h = h, .steps = 5};
    experiment_insist(tvi_integrator_create(&s.integrator, system, options), "steps");
    return s;
}

void stepping_close(stepping *s) { tvi_integrator_free(s->integrator); }

void stepping_go(void *ctx)
{
    stepping *s = ctx;
    double t = 0, q[COORDINATES_MOST], p[COORDINATES_MOST];
    const long passes = tvi_integrator_stats(s->integrator)->passes;
    memcpy(q, s->q, (size_t)s->n * sizeof *q);
    memcpy(p, s->p, (size_t)s->n * sizeof *p);
    tvi_integrator_reset(s->integrator);
    experiment_insist(tvi_integrate(s->integrator, s->h, s->steps, &t, q, p, NULL, NULL), "steps");
    s->passes = (double)(tvi_integrator_stats(s->integrator)->passes - passes) / (double)s->steps;
}

double stepping_time(const turn *t) { return 1e6 * t->seconds / (double)((const stepping *)t->ctx)->steps; }
