/* run.h - Declares one measured run: a scene from its start to its end with one method and one step. */
#ifndef RUN_H
#define RUN_H

#include "baselines/baseline.h"
#include "scenes/scene.h"

/* The program that runs a scene: a method of the library, or a baseline. */
typedef struct {
    const char *name; /* of the method, in tables */
    int order;
    bool symplectic;
    tvi_options options;      /* of a method of the library, */
    bool is_compiled;         /* with code that is generated for the scene */
    const baseline *baseline; /* NULL: a method of the library */
} contender;

typedef struct {
    const scene *scene;
    const contender *who; /* NULL: of run_measure */
    const char *method;   /* its name in tables: the caller's */
    int order, degree;    /* order as asked for, degree as resolved; a baseline has no degree: 0 */
    double setting;       /* h, or the tolerance of a baseline that chooses its own steps */
    double h;             /* then the mean of them */
    long steps;
    double cpu;             /* s: the fastest of several repetitions, without making the system and the integrator */
    double whole;           /* s: the whole measurement, repetitions included */
    double energy_error;    /* max |H - H0| / max(|H0|, energy_scale), over all steps or RUN_SAMPLES at least */
    double end_error;       /* maximum norm of (q,p) - reference at t_end */
    double position_error;  /* 2-norm of q - reference */
    long force_evaluations; /* of one run */
    double passes_per_step;
    tvi_status status; /* not TVI_OK: failed_step failed, and cpu and the errors are not set */
    long failed_step;  /* 0: the integrator could not be made, or a baseline */
} run;

enum { RUN_SAMPLES = 1000 };

double run_clock(void); /* CPU time of this process, s */

/* A run that takes turns begins each turn with this time that is not counted, s: the clocks of some processors fall by
 * a fifth a millisecond after vectors of 512 bits are first multiplied, and rise half a millisecond after the last
 * ones. Without it each would have a part of the other's clock. */
extern const double run_before_timing;

/* A contender before the start of a scene: h and steps, or tolerance, from the setting. */
typedef struct {
    const scene *scene;
    double h, tolerance;
    long steps;
    long at_once; /* so many runs are timed together; 0: not known yet */
    const baseline *baseline;
    tvi_integrator *integrator; /* where there is no baseline */
    baseline_counts counts;     /* of the last run */
} runner;

TVI_NODISCARD tvi_status runner_open(runner *r, const tvi_system *system, const scene *s, const contender *who,
                                     double setting);
void runner_close(runner *r);
/* From the scene's start; q[n] and p[n] receive the end. */
tvi_status runner_go(runner *r, double q[], double p[], tvi_observer *observer, void *ctx);
double runner_time(runner *r); /* CPU time, the fastest of several repetitions; infinite where it fails */

/* Runs the scene once with an observer for the errors and some times without one for the time. Sets all but method. */
void run_measure(const tvi_system *system, const scene *s, const tvi_options *options, double h, run *result);

/* The same for any contender; status is TVI_ESTOPPED where the first run is not over at `deadline` of
 * run_clock. */
void run_contender(const tvi_system *system, const scene *s, const contender *who, double setting, double deadline,
                   run *result);

/* The CPU times of two runs of one scene, made in turns, so that what else the machine does meets both: the fastest of
 * each. */
void run_in_turns(const tvi_system *system, const run *a, const run *b, double cpu[2]);

#endif
