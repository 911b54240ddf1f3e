/* advance.c - Compiles the loops of advance.h for several members, once for each instruction set. */
#include "run/advance.h"
#include "rule.h"

static void find_overflows(int rows, int width, const double *x, const double *low, const double *dx, double *overflows)
{
    tvi_find_overflows(rows, width, x, low, dx, overflows);
}

static void advance(int rows, int width, double *x, double *low, const double *dx, const double *dx_low,
                    const tvi_status *status)
{
    tvi_advance(rows, width, x, low, dx, dx_low, status);
}

const tvi_advance_loops JET_FOR_ISA(tvi_advance_loops) = {find_overflows, advance};
