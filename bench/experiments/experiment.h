/* experiment.h - Declares what the programs of the paper's figures share: files with a head, methods by name, runs, and
 * the energy along them. Each program takes one argument, the folder for its CSV files and for the tables of
 * docs/experiments.md. A failure ends the program, with a message. */
#ifndef EXPERIMENT_H
#define EXPERIMENT_H

#include "runs/run.h"

#include <stdio.h>

/* ---- Files ---------------------------------------------------------------------------------------------------- */

typedef struct {
    const char *dir;
    int argc;
    char **argv;
} experiment;

/* From main's arguments; makes the folder. */
experiment experiment_begin(int argc, char *argv[]);
/* DIR/NAME.csv with compiler, flags, processor and command in comments, then the columns. */
FILE *experiment_csv(const experiment *e, const char *name, const char *columns);
/* DIR/NAME.md with the head of a table: titles separated by '|'. A title that ends in "(time)" or "(chaotic)" tells
 * that nobody should get the same numbers again. */
FILE *experiment_table(const experiment *e, const char *name, const char *titles);
void experiment_close(FILE *file);
/* A line on stderr. */
void experiment_progress(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* A cell " TEXT |" with two digits of an error; a dash where it is not finite, "lost" where it is above `lost`. */
void experiment_cell(FILE *table, double error, double lost);

/* ---- Methods -------------------------------------------------------------------------------------------------- */

/* A named method of the library or a baseline. The options and the label may be changed before a run. */
typedef struct {
    char label[48]; /* "tvi 6" */
    contender who;
} experiment_method;

/* The method refuses no step for being too large, as those of the paper do not. */
experiment_method experiment_find(const char *name, int order);
/* The same with another quadrature; said is what the label says of it. */
experiment_method experiment_find_with(const char *name, int order, tvi_quadrature quadrature, int points,
                                       const char *said);
/* N of the curve, the derivatives that a step uses; -1 for a baseline. */
int experiment_degree(const experiment_method *method, const tvi_system *system);
/* The scene's system. */
tvi_system *experiment_system(const scene *s);

/* ---- Runs ----------------------------------------------------------------------------------------------------- */

/* The start and the end of a run are those of its scene: a copy of a scene may have others. */
typedef struct {
    tvi_status status;
    long steps; /* that succeeded, of a method of the library */
    double q[BASELINE_N_MAX], p[BASELINE_N_MAX];
    double cpu, passes_per_step; /* cpu in s, without the observer; NAN unless it was asked for */
} experiment_end;

experiment_end experiment_run(const experiment_method *method, const tvi_system *system, const scene *s, double h,
                              tvi_observer *observer, void *ctx, bool timed);

/* Ends the program with a message. */
__attribute__((noreturn)) void experiment_fail(const char *what, const char *why);
/* Ends the program where it is not TVI_OK, with the text of the last error. */
void experiment_insist(tvi_status status, const char *what);
/* Generated code of a system, from the cache DIR/generated. */
tvi_compiled *experiment_compile(const experiment *e, const tvi_system *system, const tvi_options *options);
/* 2-norm of q - q_exact. */
double experiment_distance(int n, const double q[], const double q_exact[]);

/* ---- The energy along a run ----------------------------------------------------------------------------------- */

/* Statistics of the relative errors e = (H - H0)/max(|H0|, scale) at times t. A value that is not finite makes all
 * infinite. */
typedef struct {
    const tvi_system *system;
    double start, scale;
    double last, worst, sum; /* e, max |e|, sum |e| */
    long count;
    double t, tt, e, te; /* sums for the line through them */
} experiment_energy;

experiment_energy experiment_energy_begin(const tvi_system *system, const scene *s);
/* Takes the state into account; returns e. */
double experiment_energy_note(experiment_energy *energy, double t, const double q[], const double p[]);
int experiment_energy_watch(long step, double t, const double q[], const double p[], void *energy); /* an observer */
double experiment_energy_mean(const experiment_energy *energy);                                     /* of |e| */
double experiment_energy_slope(const experiment_energy *energy); /* of the line through the points (t, e) */

/* ---- Work and precision --------------------------------------------------------------------------------------- */

typedef struct {
    double h, cpu, passes, mean_energy, max_energy, error; /* error: INFINITY where the run fails or is not finite */
} experiment_point;

/* Over the scene's steps, to the scene's end and reference. */
typedef struct {
    const char *name; /* of the CSV file and of the table */
    const scene *scene;
    bool by_energy;    /* the table is about the mean energy error; otherwise about the error of the position */
    double shown[3];   /* h of the table's columns of errors, falling; passes are those of the second */
    double targets[3]; /* errors of its columns of times */
    double longest;    /* below the last step shown a ladder ends where a run would take longer, s, or at roundoff */
} experiment_sweep;

/* Every method over the steps: DIR/NAME.csv and DIR/NAME.md. */
void experiment_sweep_run(const experiment *e, const experiment_sweep *sweep, int count,
                          const experiment_method methods[]);

#endif
