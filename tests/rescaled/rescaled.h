/* rescaled.h - Declares what the suites of rescaled systems share: runs, and problems with closed forms or without
 * symmetry. */
#ifndef TESTS_RESCALED_H
#define TESTS_RESCALED_H

#include "tvi.h"

#include <check.h>

Suite *suite_scale(void);
Suite *suite_automatic(void);
Suite *suite_structure(void);
Suite *suite_orders(void);
Suite *suite_times(void);
Suite *suite_tangent(void);
Suite *suite_refused(void);
Suite *suite_scenes(void);
Suite *suite_passes(void);
Suite *suite_reversible(void);

enum { MOST_N = 8 };

/* n = 2, masses 1: V = -1/r. */
jet kepler(const jet q[], jet t, void *ctx);
/* g = r^(3/2). */
jet kepler_scale(const jet q[], const jet p[], jet t, void *ctx);
/* n = 2, masses 1 and 2.5: V = k(t) (x^2 + 2 y^2 + x y) / 2 + x^4 / 4 + x^2 y, k(t) = 1 + cos(t) / 2. */
extern const double driven_mass[2];
jet driven(const jet q[], jet t, void *ctx);
/* Its g, of q, p and t: 1 / (1 + x^2 + p_y^2 / 4 + sin(t) / 4). */
jet driven_scale(const jet q[], const jet p[], jet t, void *ctx);

typedef struct {
    double t, q[MOST_N], p[MOST_N];
} state;

/* Kepler from the pericentre of an orbit with a = 1, and where it is at t. */
state kepler_start(double e);
state kepler_at(double e, double t);
state driven_start(void);
/* The largest difference of a coordinate, a momentum or the time. */
double state_distance(int n, const state *a, const state *b);

typedef struct {
    tvi_system *system;
    tvi_integrator *integrator;
    state x;
} run;

/* Both end the test where they fail; of open_rescaled the base is freed. method NULL: the default. */
tvi_system *rescaled_system(int n, const double mass[], tvi_potential_fn *potential, tvi_rescale_fn *g);
/* With the automatic g. */
tvi_system *rescaled_hamiltonian(int n, tvi_hamiltonian_fn *H, void *ctx);
run open_run(tvi_system *system, const char *method, int order, const state *start);
run open_kepler(double e, tvi_rescale_fn *g, const char *method, int order);
/* g at a state: dt/ds = K_e. */
double scale_at(const tvi_system *rescaled, const state *x);
void close_run(run *r);
tvi_status run_steps(run *r, double h, long steps);

/* The methods that serve. */
typedef struct {
    const char *name;
    int order;
    bool composed;
} served;
extern const served all_served[];
enum { SERVED = 14 };
tvi_options options_of(const served *method);

#endif
