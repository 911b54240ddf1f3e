/* bodies.h - Declares systems of any size. */
#ifndef BODIES_H
#define BODIES_H

#include "tvi.h"

enum { COORDINATES_MOST = 120 };

typedef struct {
    const char *name;
    int n;
    tvi_system *system;
    double q[COORDINATES_MOST], p[COORDINATES_MOST];
    double h; /* a step of order 16 */
} big_system;

/* A star of mass 1 and count - 1 planets on nearly circular orbits around it, in 2 or 3 dimensions; G = 1, and the
 * innermost year is 10.4. All attract each other. */
big_system bodies_make(int count, int dimensions);

#endif
