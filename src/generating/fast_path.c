/* fast_path.c - compiles the fast-path step (curve_step.h: a whole step in the common case that passes
 * converge as usual, without fallbacks), the seeds of the action and the rescaling of a curve for one instruction set,
 * and lists all functions compiled for it. The build compiles this file once for each instruction set; choose.c selects
 * among the results. */
#include "generating/fast_path.h"
#include "generating/step_size.h"

static bool try_fast_path_step(tvi_curve_workspace *work, double tau, const tvi_step_origin *origin, double dq[],
                               double dp[], tvi_stats *stats)
{
    static const fast_path_expansion_and_seed_functions functions = {
        curve_expand_series, fast_path_expand_with_tangents, seeds_compute_adjoint_seeds_from_field_only};
    return step_try_fast_path_step(work, &functions, tau, origin, dq, dp, stats);
}

const tvi_curve_isa_functions JET_FOR_ISA(tvi_curve_isa_functions) = {
    .rescale_and_sum = curve_rescale_and_sum,
    .compute_seeds = seeds_compute_adjoint_seeds_from_field_only,
    .fast_path_step = try_fast_path_step,
    .matrix_free_solver = &JET_FOR_ISA(tvi_solver_by_products)};
