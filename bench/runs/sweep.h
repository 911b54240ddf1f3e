/* sweep.h - Declares lines of runs: a contender over a scene's ladder of steps, within a budget of time. */
#ifndef SWEEP_H
#define SWEEP_H

#include "contenders.h"
#include "report.h"

enum { SWEEP_COMPILED_MOST = 32 };
typedef struct {
    report report;
    double begin, end;       /* of run_clock: when the sweeps began, and must be over */
    double longest;          /* s: no measurement may take longer; 0 = only the budget ends it */
    double enough;           /* a line ends below this error; 0 = at roundoff */
    report_error *enough_of; /* which error; NULL = of the position */
    double dearest;          /* a line ends at a run that takes this many times the time of a better one; 0 = never */
    const char *only;        /* of the contenders' names; NULL = all */
    long failed, skipped;    /* runs of the scene */
    contender compiled[SWEEP_COMPILED_MOST]; /* those with code, of all scenes: the rows know them */
    int compiled_count;
} sweep;

/* Frees the code of compiled contenders, which the rows of the report need no more. */
void sweep_close(sweep *b);

/* Every contender that serves the scene, each with twice an equal share of the time that is left until `end`: the first
 * get most. false: the scene cannot be made, or no memory. */
bool sweep_scene(sweep *b, const scene *s, const contenders *list, double end);

/* When a part of the time from now until `end` is over. */
double sweep_share(double end, double part);

/* OpenBLAS reads its number of threads when it is loaded: starts the program again with one. */
void sweep_insist_on_one_thread(char *const argv[]);

#endif
