/* run.h - one measured run: a scene from its start to its end with one method and one step. */
#ifndef RUN_H
#define RUN_H

#include "scenes/scene.h"

typedef struct {
    const scene *scene;
    const char *method;         /* its name in tables: the caller's */
    int order, degree;          /* order as asked for, degree as resolved */
    double h;
    long steps;
    double cpu;                 /* s: the fastest of several repetitions, without making the system and the integrator */
    double energy_error;        /* max |H - H0| / max(|H0|, energy_scale), over all steps or RUN_SAMPLES at least */
    double end_error;           /* maximum norm of (q,p) - reference at t_end */
    double position_error;      /* 2-norm of q - reference */
    long force_evaluations;     /* of one run */
    double passes_per_step;
    tvi_status status;          /* not TVI_OK: failed_step failed, and cpu and the errors are not set */
    long failed_step;           /* 0: the integrator could not be made */
} run;

enum { RUN_SAMPLES = 1000 };

double run_clock(void);         /* CPU time of this process, s */

/* Seconds that run_measure will take, from a few steps; 0 where those fail, as the run then ends soon. */
double run_predict(const tvi_system *system, const scene *s, const tvi_options *options, double h);

/* Runs the scene once with an observer for the errors and some times without one for the time. Sets all but method. */
void run_measure(const tvi_system *system, const scene *s, const tvi_options *options, double h, run *result);

#endif
