/* tolerance.h - Declares runs of "taylor" to a tolerance. */
#ifndef TESTS_EVENTS_TOLERANCE_H
#define TESTS_EVENTS_TOLERANCE_H

#include "scene.h"

#include <check.h>

enum { LARGEST_N = 18 };

typedef struct {
    tvi_system *system;
    tvi_integrator *integrator;
    int n;
    double t, q[LARGEST_N], p[LARGEST_N];
} orbit;

orbit open_scene(const scene *s, int order);
orbit open_potential(tvi_potential_fn *potential, int order, double q, double p); /* one degree of freedom, mass 1 */
void open_integrator(orbit *o, const char *method, int order);
void close_orbit(orbit *o);
tvi_status go(orbit *o, double tolerance, double t_end, tvi_observer *observer, void *ctx);
long steps_of(const orbit *o);
/* The larger of max |x - y| / max |y| of q and of p. */
double error_of(const orbit *o, const double q[], const double p[]);

#endif
