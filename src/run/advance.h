/* advance.h - Adds the increments of a step to the states of all members by compensated summation. step.c calls it.
 * Arrays are [rows][width], the member fastest. */
#ifndef TVI_SRC_RUN_ADVANCE_H
#define TVI_SRC_RUN_ADVANCE_H

#include "method/origin.h"
#include "tvi.h"

/* overflows[member] becomes different from 0 if the sum x + (low + dx) is not finite in some row. */
static inline void tvi_find_overflows(int rows, int width, const double *restrict x, const double *restrict low,
                                      const double *restrict dx, double *restrict overflows)
{
    for (int row = 0; row < rows; row++, x += width, low += width, dx += width)
        for (int m = 0; m < width; m++) {
            const double sum = x[m] + (low[m] + dx[m]);
            overflows[m] += sum - sum;
        }
}

/* (x, low) <- x + low + dx + dx_low of the members whose status is TVI_OK. */
static inline void tvi_advance(int rows, int width, double *restrict x, double *restrict low, const double *restrict dx,
                               const double *restrict dx_low, const tvi_status *restrict status)
{
    for (int row = 0; row < rows; row++, x += width, low += width, dx += width, dx_low += width)
        for (int m = 0; m < width; m++) {
            double rest = low[m];
            const double sum = tvi_add_compensated(x[m], &rest, dx[m], dx_low[m]);
            x[m] = status[m] == TVI_OK ? sum : x[m];
            low[m] = status[m] == TVI_OK ? rest : low[m];
        }
}

/* The two functions for several members, compiled once for each instruction set (ad/vector.h). */
typedef struct {
    void (*find_overflows)(int rows, int width, const double *x, const double *low, const double *dx,
                           double *overflows);
    void (*advance)(int rows, int width, double *x, double *low, const double *dx, const double *dx_low,
                    const tvi_status *status);
} tvi_advance_loops;

extern const tvi_advance_loops tvi_advance_loops_base, tvi_advance_loops_avx2, tvi_advance_loops_avx512;

#endif
