/* tolerance.c - Implements tolerance.h. */
#include "tolerance.h"

#include <math.h>
#include <string.h>

void open_integrator(orbit *o, const char *method, int order)
{
    tvi_options options;
    ck_assert_int_eq(tvi_options_named(method, order, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&o->integrator, o->system, &options), TVI_OK);
}

orbit open_scene(const scene *s, int order)
{
    orbit o = {.n = s->n};
    ck_assert_int_eq(scene_system(s, &o.system), TVI_OK);
    open_integrator(&o, "taylor", order);
    memcpy(o.q, s->q, (size_t)s->n * sizeof *s->q);
    memcpy(o.p, s->p, (size_t)s->n * sizeof *s->p);
    return o;
}

orbit open_potential(tvi_potential_fn *potential, int order, double q, double p)
{
    orbit o = {.n = 1, .q = {q}, .p = {p}};
    ck_assert_int_eq(tvi_system_potential(&o.system, 1, NULL, potential, NULL), TVI_OK);
    open_integrator(&o, "taylor", order);
    return o;
}

void close_orbit(orbit *o)
{
    tvi_integrator_free(o->integrator);
    tvi_system_free(o->system);
}

tvi_status go(orbit *o, double tolerance, double t_end, tvi_observer *observer, void *ctx)
{
    return tvi_integrate_tolerance(o->integrator, tolerance, t_end, &o->t, o->q, o->p, observer, ctx);
}

long steps_of(const orbit *o) { return tvi_integrator_stats(o->integrator)->steps; }

/* max |x - y| / max |y|. */
static double distance(int n, const double x[], const double y[])
{
    double apart = 0, size = 0;
    for (int i = 0; i < n; i++) {
        apart = fmax(apart, fabs(x[i] - y[i]));
        size = fmax(size, fabs(y[i]));
    }
    return apart / size;
}

double error_of(const orbit *o, const double q[], const double p[])
{
    return fmax(distance(o->n, o->q, q), distance(o->n, o->p, p));
}
