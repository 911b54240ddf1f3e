/* closure.c - solves the equations that the closing functions of the generating functions share (closure.h). type1.c
 * to type3_start.c and the descriptors' `close` call these functions. */
#include "generating/closure.h"

tvi_status tvi_solve_transposed_half(tvi_closure *closure, const tvi_combination *combination, tvi_half half)
{
    return closure->solver->solve(closure, &(tvi_transposed_equations){combination, NULL, half});
}

tvi_status tvi_solve_transposed_full(tvi_closure *closure, const tvi_combination *first, const tvi_combination *second)
{
    return closure->solver->solve(closure, &(tvi_transposed_equations){first, second, TVI_FIRST});
}

tvi_status tvi_close_by_mean_of_ends(tvi_closure *closure)
{
    const tvi_status status = tvi_solve_transposed_full(closure, &closure->q_mean, closure_partner_of_mean(closure));
    if (status != TVI_OK) return status;
    closure_correct_ends(closure);
    return TVI_OK;
}
