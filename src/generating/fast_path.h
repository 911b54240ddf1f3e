/* fast_path.h - expands a curve with its tangents by the sweeps compiled for one instruction set. fast_path.c calls
 * it. */
#ifndef TVI_SRC_GENERATING_FAST_PATH_H
#define TVI_SRC_GENERATING_FAST_PATH_H

#define CURVE_ONE_SET
#include "sums.h"

#include "generating/curve_step.h"

extern const tvi_end_correction_solver JET_FOR_ISA(tvi_solver_by_products);

static inline tvi_status fast_path_expand_with_tangents(tvi_curve *curve)
{
    const tvi_status status = curve_expand_series(curve);
    if (status == TVI_OK) curve_compute_jacobians(curve);
    return status;
}

#endif
