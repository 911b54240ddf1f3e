/* finite.h - whether all numbers of an array are finite. */
#ifndef TVI_SRC_FINITE_H
#define TVI_SRC_FINITE_H

#include <math.h>
#include <stdbool.h>

static inline bool tvi_all_finite(int n, const double x[])
{
    for (int i = 0; i < n; i++)
        if (!isfinite(x[i])) return false;
    return true;
}

#endif
