/* advance.h - Adds the increments of a step to the states of all members by compensated summation. step.c calls it.
 * Arrays of members have the shape [components][width]: the values of one component for all `width` members are
 * adjacent. A number in two parts is x + x_low, with the rounded value x and the low-order part x_low. */
#ifndef TVI_SRC_RUN_ADVANCE_H
#define TVI_SRC_RUN_ADVANCE_H

#include "method/origin.h"
#include "tvi.h"

/* Makes overflow_flags[member] different from 0 if the sum x + (x_low + dx) of a component is not finite, and leaves it
 * as it is otherwise. */
static inline void tvi_find_overflows(int component_count, int width, const double *restrict x,
                                      const double *restrict x_low, const double *restrict dx,
                                      double *restrict overflow_flags)
{
    for (int i = 0; i < component_count; i++, x += width, x_low += width, dx += width)
        for (int m = 0; m < width; m++) {
            const double sum = x[m] + (x_low[m] + dx[m]);
            overflow_flags[m] += sum - sum;
        }
}

/* Computes (x, x_low) <- x + x_low + dx + dx_low for the members whose status is TVI_OK. */
static inline void tvi_add_increments(int component_count, int width, double *restrict x, double *restrict x_low,
                                      const double *restrict dx, const double *restrict dx_low,
                                      const tvi_status *restrict status)
{
    for (int i = 0; i < component_count; i++, x += width, x_low += width, dx += width, dx_low += width)
        for (int m = 0; m < width; m++) {
            double rest = x_low[m];
            const double sum = tvi_add_compensated(x[m], &rest, dx[m], dx_low[m]);
            x[m] = status[m] == TVI_OK ? sum : x[m];
            x_low[m] = status[m] == TVI_OK ? rest : x_low[m];
        }
}

/* Pointers to tvi_find_overflows and tvi_add_increments, compiled for several members, once for each instruction set
 * (ad/vector.h). */
typedef struct {
    void (*find_overflows)(int component_count, int width, const double *x, const double *x_low, const double *dx,
                           double *overflow_flags);
    void (*add_increments)(int component_count, int width, double *x, double *x_low, const double *dx,
                           const double *dx_low, const tvi_status *status);
} tvi_increment_kernels_of_instruction_set;

extern const tvi_increment_kernels_of_instruction_set tvi_increment_kernels_of_instruction_set_base,
    tvi_increment_kernels_of_instruction_set_avx2, tvi_increment_kernels_of_instruction_set_avx512;

#endif
