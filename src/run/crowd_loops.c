/* crowd_loops.c - see crowd_loops.h. */
#include "run/crowd_loops.h"
#include "rule.h"

#include <float.h>
#include <math.h>

static void check(int rows, int width, const double *x, const double *dx, double *overflows)
{
    for (int row = 0; row < rows; row++, x += width, dx += width)
        for (int lane = 0; lane < width; lane++)
            overflows[lane] = fabs(x[lane] + dx[lane]) <= DBL_MAX ? overflows[lane] : 1;
}

static void advance(int rows, int width, double *restrict x, double *restrict low, const double *restrict dx,
                    const double *restrict dx_low, const tvi_status *restrict status)
{
    for (int row = 0; row < rows; row++, x += width, low += width, dx += width, dx_low += width)
        for (int lane = 0; lane < width; lane++) {
            double rest = low[lane];
            const double sum = tvi_add_compensated(x[lane], &rest, dx[lane], dx_low[lane]);
            x[lane] = status[lane] == TVI_OK ? sum : x[lane];
            low[lane] = status[lane] == TVI_OK ? rest : low[lane];
        }
}

const tvi_crowd_loops JET_FOR_ISA(tvi_crowd_loops) = {check, advance};
