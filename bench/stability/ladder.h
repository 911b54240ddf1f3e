/* ladder.h - Declares steps from far too large to small, each beside one that the guard does not look at: which are
 * refused, and which of these were right. */
#ifndef STABILITY_LADDER_H
#define STABILITY_LADDER_H

#include "hard_run.h"

/* A start, and the time that is cut into 6 to 3200 steps. */
typedef struct {
    const char *title;
    const scene *problem;
    double period;
} ladder_case;
extern const ladder_case ladder_cases[]; /* of NULL ends */

/* The part of the energy's scale, the largest of energy_scale and |H| where the run and where the step begins, that no
 * step may change; and how close to the solution a step is right: in q and p, each relative to its largest component,
 * and in H, relative to its scale. */
#define LADDER_WRONG 0.05
#define LADDER_RIGHT 1e-3

typedef struct {
    long accepted, wrong;     /* wrong: though the energy changed by more than LADDER_WRONG */
    long refused;             /* with TVI_ETOOLARGE, and of these: */
    long right, near, unread; /* right; near: right in q and p, not in H; unread: that have no solution to compare */
    long failed;              /* with another status */
    double most;              /* the largest change of the energy of an accepted step */
} ladder_counts;

void ladder_add(ladder_counts *sum, const ladder_counts *more);

/* steps steps of size h from the start; after one that is not accepted a new run goes on
 * from the solution. Does nothing if the method does not serve the system. */
ladder_counts ladder_climb(const ladder_case *c, const hard_method *m, double h, int steps);

/* The method called name, at its orders 8 and 16 (or 2), or 0 where it has no order at that place. */
enum { LADDER_ORDERS = 2 };
hard_method ladder_method(const char *name, int place);

/* Tells whether the method is explicit, of which the guard does not demand that each step keeps the energy. */
bool ladder_is_explicit(const hard_method *m);

#endif
