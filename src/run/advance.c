/* advance.c - Compiles the loops of advance.h for several members, once for each instruction set. */
#include "run/advance.h"
#include "rule.h"

static void find_overflows(int components, int width, const double *x, const double *x_low, const double *dx,
                           double *overflows)
{
    tvi_find_overflows(components, width, x, x_low, dx, overflows);
}

static void add_increments(int components, int width, double *x, double *x_low, const double *dx, const double *dx_low,
                           const tvi_status *status)
{
    tvi_add_increments(components, width, x, x_low, dx, dx_low, status);
}

const tvi_state_update_loops JET_FOR_ISA(tvi_state_update_loops) = {find_overflows, add_increments};
