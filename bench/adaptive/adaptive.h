/* adaptive.h - Declares runs with fixed and rescaled steps on the hard scenes, for docs/adaptive.md. */
#ifndef ADAPTIVE_H
#define ADAPTIVE_H

#include "experiments/experiment.h"
#include "scenes/hard.h"

#define ADAPTIVE_REVOLUTION 6.2831853071795864769 /* of the Kepler scenes, in t */
/* How long it is in s = int r^(-3/2) dt. */
#define ADAPTIVE_S_90  8.3680815995493827
#define ADAPTIVE_S_99  11.446353648528003
#define ADAPTIVE_S_999 14.674775077677475

typedef enum { ADAPTIVE_FIXED, ADAPTIVE_OWN, ADAPTIVE_AUTOMATIC, ADAPTIVE_TOLERANCE } adaptive_g;

typedef struct {
    const hard_scene *problem; /* NULL ends a list */
    const char *method;
    int order;
    adaptive_g g;
    double h; /* in t of fixed steps, in s of rescaled ones; of ADAPTIVE_TOLERANCE the tolerance */
} adaptive_line;

extern const adaptive_line adaptive_lines[];  /* rows of the table */
extern const adaptive_line adaptive_errors[]; /* curves of the picture: error against time */
extern const adaptive_line adaptive_steps[];  /* step against time */

typedef struct {
    tvi_system *system, *rescaled; /* rescaled: NULL where the steps are not */
    tvi_integrator *integrator;
    double t, q[BASELINE_N_MAX], p[BASELINE_N_MAX];
} adaptive_motion;

adaptive_motion adaptive_begin(const adaptive_line *line);
tvi_status adaptive_go(adaptive_motion *motion, const adaptive_line *line, double t_end, tvi_observer *observer,
                       void *ctx);
void adaptive_end(adaptive_motion *motion);
/* CPU time of a run, s: the fastest of some. The unit: Gauss collocation of order 16 by hand, steps of 0.25, Kepler e =
 * 0.36 to 250. */
double adaptive_time_of(const adaptive_line *line, int repetitions);
double adaptive_time_of_unit(void);

/* Writes tolerance.md: the error at the end of a run to a tolerance. */
void adaptive_tolerances(const experiment *e);

/* Relative to the scene's scale; NAN where the energy is of the time, and not kept. */
double adaptive_energy_error(const adaptive_motion *motion, const scene *problem);
/* The distance of q from the solution, the 2-norm; NAN where it is not known. */
double adaptive_error(const hard_scene *problem, double t, const double q[]);

#endif
