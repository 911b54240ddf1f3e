/* closure.c - solves the equations of the generating functions, and computes from their solution the small corrections
 * by which the ends of the step differ from those of the Taylor curve (closure.h). The methods' functions
 * `correct_ends` call it. */
#include "generating/closure.h"

static tvi_status correct_ends(tvi_closure *closure, const tvi_correction_equations *equations)
{
    const tvi_status status = closure->solver->solve(closure, equations);
    if (status == TVI_OK) closure_set_end_corrections(closure);
    return status;
}

tvi_status tvi_correct_ends_by_mean(tvi_closure *closure)
{
    return correct_ends(closure,
                        &(tvi_correction_equations){&closure->q_mean_weights, closure_get_second_combination(closure),
                                                    TVI_FIRST_COLUMNS});
}

tvi_status tvi_correct_ends_by_block(tvi_closure *closure, const tvi_combination *combination,
                                     tvi_column_half column_half)
{
    return correct_ends(closure, &(tvi_correction_equations){combination, NULL, column_half});
}
