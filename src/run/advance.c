/* advance.c - Adds the increments of a step to the states of a batch of members, and finds members whose new state
 * would not be finite. The file is compiled once for each instruction set, and step.c calls the version for the
 * processor at hand. The loops are in advance.h. */
#include "run/advance.h"
#include "rule.h"

static void find_overflows(int component_count, int width, const double *x, const double *x_low, const double *dx,
                           double *overflow_flags)
{
    tvi_find_overflows(component_count, width, x, x_low, dx, overflow_flags);
}

static void add_increments(int component_count, int width, double *x, double *x_low, const double *dx,
                           const double *dx_low, const tvi_status *status)
{
    tvi_add_increments(component_count, width, x, x_low, dx, dx_low, status);
}

const tvi_increment_kernels_of_instruction_set JET_FOR_ISA(tvi_increment_kernels_of_instruction_set) = {find_overflows,
                                                                                                        add_increments};
