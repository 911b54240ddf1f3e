/* adaptive.h - fixed and rescaled steps on the hard scenes, for docs/adaptive.md. */
#ifndef ADAPTIVE_H
#define ADAPTIVE_H

#include "experiments/experiment.h"
#include "scenes/hard.h"

typedef enum { ADAPTIVE_FIXED, ADAPTIVE_OWN, ADAPTIVE_AUTOMATIC, ADAPTIVE_TOLERANCE } adaptive_g;

typedef struct {
    const hard_scene *of; /* NULL ends a list */
    const char *method;
    int order;
    adaptive_g g;
    double h;    /* in t of fixed steps, in s of rescaled ones; of ADAPTIVE_TOLERANCE the tolerance */
    int lengths; /* the run is that many times as long as the scene's; 0 = 1 */
    bool is_timed;
} adaptive_line;

extern const adaptive_line adaptive_lines[];  /* rows of the table */
extern const adaptive_line adaptive_errors[]; /* curves of the picture: error against time */
extern const adaptive_line adaptive_steps[];  /* step against time */

/* The distance of q from the solution, the 2-norm; NAN where it is not known. */
double adaptive_error(const hard_scene *of, double t, const double q[]);

#endif
