/* longrun.h - Declares how roundoff grows: runs of many orbits that differ by 1e-12, and what their energies and
 * angular momenta say (docs/roundoff.md). */
#ifndef LONGRUN_H
#define LONGRUN_H

#include "experiments/experiment.h"
#include "hard.h"

enum { LONGRUN_ORBITS_MAX = 2048, LONGRUN_SAMPLES_MAX = 80, LONGRUN_N_MAX = 18, LONGRUN_WINDOW = 256 };

/* The angular momentum is that about the axis of q[2], of all bodies of three coordinates, or of one in the plane. */
typedef enum { LONGRUN_ENERGY, LONGRUN_MOMENTUM, LONGRUN_QUANTITIES } longrun_quantity;

/* How the steps are made: by the library, by the library without its low-order parts, by longrun/rounded.h, by
 * longrun/sooner.h, by longrun/nearest.h. */
typedef enum { LONGRUN_COMPENSATED, LONGRUN_PLAIN, LONGRUN_ROUNDED, LONGRUN_SOONER, LONGRUN_NEAREST } longrun_sums;

/* The bounds that `make longrun` insists on: all bounds, one bound at least missed, or nothing. */
typedef enum { LONGRUN_HOLDS, LONGRUN_FAILS, LONGRUN_SHOWN } longrun_duty;

/* Constraints of a scene, with its potential. Starts are near them. */
typedef struct {
    scene scene;
    int m;
    tvi_constraint_fn *phi;
} longrun_constraints;

/* Their scenes are all called "constrained" (constrained.c). */
extern const longrun_constraints longrun_pendulum, longrun_double_pendulum, longrun_water, longrun_euler_top,
    longrun_heavy_top;

typedef struct {
    const scene *scene;
    const longrun_constraints *constraints; /* of this scene, or NULL */
    const char *title, *form;               /* of the system, in the table */
    tvi_rescale_fn *scale;                  /* NULL: the time of the steps is t */
    const char *method;
    int order;
    longrun_sums sums;
    double h, steps;                       /* steps of a whole run */
    int orbits;                            /* of the whole program */
    longrun_duty duty[LONGRUN_QUANTITIES]; /* a quantity that has no meaning has no row */
    bool has_momentum;
    double rms_most; /* of the energy at the end; 0: no bound */
} longrun_line;

extern const longrun_line longrun_lines[]; /* a scene of NULL ends */

/* errors[quantity][sample][orbit] are (x - x_0) / scale, x and x_0 means over a window of steps, which ends steps[k]
 * after the window of x_0. */
typedef struct {
    const longrun_line *line;
    int orbits, samples;
    double cpu; /* s, of all threads */
    long steps[LONGRUN_SAMPLES_MAX];
    double scatter[LONGRUN_QUANTITIES][LONGRUN_ORBITS_MAX]; /* of the values in the first window */
    double errors[LONGRUN_QUANTITIES][LONGRUN_SAMPLES_MAX][LONGRUN_ORBITS_MAX];
} longrun_series;

/* Runs the orbits, to `steps` steps each. */
void longrun_run(longrun_series *series, const longrun_line *line, int orbits, double steps);

/* ---- Statistics -------------------------------------------------------------------------------------------------- */

typedef struct {
    double rms, mean, deviation;      /* at the end; of the mean: its standard error */
    double exponent, interval;        /* of the rms; half the width, 95 % */
    double scatter;                   /* of the values: roundoff of their own evaluation, truncation of the steps */
    long fit_from;                    /* steps; 0: no fit */
    bool unbiased, is_walk, is_small; /* the bounds, met where there is none */
} longrun_result;

longrun_result longrun_judge(const longrun_series *series, longrun_quantity quantity);
double longrun_rms(const longrun_series *series, longrun_quantity quantity, int sample);
double longrun_mean(const longrun_series *series, longrun_quantity quantity, int sample);

#endif
