/* stiffness.h - how the force of a separable system changes with its coordinates. */
#ifndef TVI_SRC_SYSTEM_STIFFNESS_H
#define TVI_SRC_SYSTEM_STIFFNESS_H

#include "system/system.h"

typedef struct {
    const tvi_system *system;
    double *x;  /* block of the field's series at one point */
    double *dx; /* its tangents along some directions at a time */
} tvi_stiffness;

void tvi_stiffness_take(tvi_stiffness *stiffness, tvi_arena *arena, const tvi_system *system);

/* product[k] = M^-1/2 F'(q, t) M^-1/2 along[k], [count][n] both: the matrix whose eigenvalues are -w^2 of the small
 * motions about q. How many values of the force that cost; 0 where it has none there, or no derivative. */
int tvi_stiffness_times(const tvi_stiffness *stiffness, double t, const double q[], int count, const double along[],
                        double product[]);

#endif
