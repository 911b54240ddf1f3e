/* runs.h - Declares what the suites share: every method on scenes of every form, and the invariants of Kepler. */
#ifndef TESTS_EVENTS_RUNS_H
#define TESTS_EVENTS_RUNS_H

#include "scene.h"

#include <check.h>

enum { MOST_N = 6 };

typedef struct {
    double t, q[MOST_N], p[MOST_N];
} point;

typedef struct {
    tvi_system *system;
    tvi_integrator *integrator;
    point x;
} run;

/* A method by name on a scene that it serves. */
typedef struct {
    const scene *scene;
    const char *method;
    int order;
    double h;
} pairing;
extern const pairing pairings[];
enum { PAIRINGS = 30 };

run run_open(const scene *s, const char *method, int order); /* method NULL: the default */
void run_close(run *r);
tvi_status run_steps(run *r, double h, long steps);
bool same_point(const point *a, const point *b); /* bit for bit */

/* The largest errors of the energy and the angular momentum of scene_kepler. */
typedef struct {
    double energy, momentum;
} drift;
void add_drift(drift *d, const double q[], const double p[]);

#endif
