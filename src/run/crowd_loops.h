/* crowd_loops.h - what each step of a block of members costs beside the stepper's own work, compiled once for each
 * instruction set (ad/vector.h). Arrays are [rows][width], the member fastest. */
#ifndef TVI_SRC_RUN_CROWD_LOOPS_H
#define TVI_SRC_RUN_CROWD_LOOPS_H

#include "method/stepper.h"

typedef struct {
    /* overflows[lane] is set where x + dx is not finite in some row. */
    void (*check)(int rows, int width, const double *x, const double *dx, double *overflows);
    /* (x, low) <- x + low + dx + dx_low in lanes that are TVI_OK. */
    void (*advance)(int rows, int width, double *x, double *low, const double *dx, const double *dx_low,
                    const tvi_status *status);
} tvi_crowd_loops;

extern const tvi_crowd_loops tvi_crowd_loops_base, tvi_crowd_loops_avx2, tvi_crowd_loops_avx512;

#endif
