/* corrected_curve.c - solves the equations of the generating functions, and computes from their solution the small
 * corrections by which the ends of the step differ from those of the Taylor curve (corrected_curve.h). The methods'
 * functions `solve_end_corrections` call it. */
#include "generating/corrected_curve.h"

static tvi_status solve_for_end_corrections(tvi_corrected_curve *corrected,
                                            const tvi_end_correction_equations *equations)
{
    const tvi_status status = corrected->solver->solve(corrected, equations);
    if (status == TVI_OK) ends_compute_corrections_from_solution(corrected);
    return status;
}

tvi_status tvi_solve_end_corrections_by_mean_q_jacobian(tvi_corrected_curve *corrected)
{
    return solve_for_end_corrections(corrected,
                                     &(tvi_end_correction_equations){&corrected->q_mean_weights,
                                                                     ends_get_weights_of_lower_jacobian_rows(corrected),
                                                                     TVI_FIRST_COLUMNS});
}

tvi_status tvi_solve_end_corrections_by_jacobian_block(tvi_corrected_curve *corrected,
                                                       const tvi_coefficient_combination *combination,
                                                       tvi_column_half column_half)
{
    return solve_for_end_corrections(corrected, &(tvi_end_correction_equations){combination, NULL, column_half});
}
