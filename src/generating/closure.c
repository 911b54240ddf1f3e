/* closure.c - solves the equations for the corrections of the curve's ends that several generating functions share
 * (closure.h). type1.c to type3_start.c and the descriptors' `correct_ends` call these functions. */
#include "generating/closure.h"

tvi_status tvi_solve_transposed_half(tvi_closure *closure, const tvi_combination *combination, tvi_half half)
{
    return closure->solver->solve(closure, &(tvi_transposed_equations){combination, NULL, half});
}

tvi_status tvi_solve_transposed_pair(tvi_closure *closure, const tvi_combination *first, const tvi_combination *second)
{
    return closure->solver->solve(closure, &(tvi_transposed_equations){first, second, TVI_FIRST});
}

tvi_status tvi_correct_ends_by_mean(tvi_closure *closure)
{
    const tvi_status status =
        tvi_solve_transposed_pair(closure, &closure->q_mean, closure_get_second_combination(closure));
    if (status != TVI_OK) return status;
    closure_set_corrections(closure);
    return TVI_OK;
}
