/* hard_run.h - Declares one run of a hard case, of the library or of Gauss collocation, until it fails or ends. */
#ifndef STABILITY_HARD_RUN_H
#define STABILITY_HARD_RUN_H

#include "cases.h"

typedef struct {
    const char *name; /* of tvi_options_named; "gauss" */
    int order;
    bool composed; /* with its adjoint; the order is then the composition's */
} hard_method;

/* false: no such method. Not for "gauss". */
bool hard_options(const hard_method *m, tvi_options *options);

typedef struct {
    double h;
    long steps;          /* that were made */
    tvi_status status;   /* TVI_OK to the end; TVI_ESTOPPED: the energy error rose above the case's bound */
    double energy_error; /* max |H - H0| / max(|H0|, energy_scale) over the steps made; infinite where H has no value */
    double position_error; /* largest component of q - q0, relative to the largest of q0; NAN: not known */
    double passes;         /* a step */
} hard_run;

/* steps steps of size t_end / steps. system is the case's. */
hard_run hard_run_make(const hard_case *c, const tvi_system *system, const hard_method *m, long steps);
/* All steps TVI_OK, and the energy error at most the bound. */
bool hard_run_survives(const hard_run *run);
/* The cause of the end in a word: the name of the status, "energy", "-" for none. */
const char *hard_run_cause(const hard_run *run);

#endif
