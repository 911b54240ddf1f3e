/* runs.c - Implements runs.h. */
#include "runs.h"

#include <math.h>
#include <string.h>

const pairing pairings[] = {
    {&scene_kepler, "galerkin", 16, 0.25},
    {&scene_kepler, "galerkin", 4, 0.05},
    {&scene_pendulum, "galerkin", 12, 0.1},
    {&scene_nonseparable, "galerkin", 8, 0.1},
    {&scene_vortices, "galerkin", 8, 0.05},
    {&scene_degenerate, "galerkin", 6, 0.05},
    {&scene_double_pendulum, "galerkin", 10, 0.02},
    {&scene_magnetic, "galerkin", 8, 0.1},
    {&scene_kepler, "midpoint", 20, 0.25},
    {&scene_kepler, "midpoint", 6, 0.1},
    {&scene_kepler, "start", 6, 0.1},
    {&scene_kepler, "end", 6, 0.1},
    {&scene_kepler, "both-ends", 8, 0.1},
    {&scene_kepler, "symmetric-tvi", 4, 0.1},
    {&scene_kepler, "tvi", 4, 0.05},
    {&scene_kepler, "right", 8, 0.1},
    {&scene_kepler, "left", 8, 0.1},
    {&scene_kepler, "poincare", 20, 0.25},
    {&scene_kepler, "taylor", 12, 0.1},
    {&scene_kepler, "stormer-verlet", 2, 0.05},
    {&scene_kepler, "svhd", 2, 0.05},
    {&scene_double_pendulum, "midpoint", 8, 0.02},
    {&scene_double_pendulum, "both-ends", 8, 0.02},
    {&scene_magnetic, "midpoint", 8, 0.1},
    {&scene_magnetic, "start", 4, 0.1},
    {&scene_nonseparable, "midpoint", 8, 0.1},
    {&scene_nonseparable, "poincare", 8, 0.1},
    {&scene_vortices, "poincare", 8, 0.05},
    {&scene_degenerate, "right", 6, 0.05},
    {&scene_pendulum, "midpoint", 12, 0.1},
};

run run_open(const scene *s, const char *method, int order)
{
    run r = {0};
    tvi_options options;
    ck_assert_int_le(s->n, MOST_N);
    ck_assert_int_eq(scene_system(s, &r.system), TVI_OK);
    if (method) ck_assert_int_eq(tvi_options_named(method, order, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&r.integrator, r.system, method ? &options : NULL), TVI_OK);
    memcpy(r.x.q, s->q, (size_t)s->n * sizeof *s->q);
    memcpy(r.x.p, s->p, (size_t)s->n * sizeof *s->p);
    return r;
}

void run_close(run *r)
{
    tvi_integrator_free(r->integrator);
    tvi_system_free(r->system);
}

tvi_status run_steps(run *r, double h, long steps)
{
    return tvi_integrate(r->integrator, h, steps, &r->x.t, r->x.q, r->x.p, NULL, NULL);
}

bool same_point(const point *a, const point *b) { return memcmp(a, b, sizeof *a) == 0; }

void add_drift(drift *d, const double q[], const double p[])
{
    d->energy = fmax(d->energy, fabs((p[0] * p[0] + p[1] * p[1]) / 2 - 1 / hypot(q[0], q[1]) + 0.68));
    d->momentum = fmax(d->momentum, fabs(q[0] * p[1] - q[1] * p[0] - 0.8));
}
