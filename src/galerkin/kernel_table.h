/* kernel_table.h - gives the table of the functions that kernel.h has just defined, for loops.c. */
static const galerkin_kernels NAME(kernels) = {
    .start = NAME(start),
    .start_drifting = NAME(start_drifting),
    .predict = NAME(predict),
    .set_sizes = NAME(set_sizes),
    .move = NAME(move),
    .integrate = NAME(integrate),
    .end_drifting = NAME(end_drifting),
    .end = NAME(end),
    .tail = NAME(tail),
#if MEMBERS
    .judge = NAME(judge),
#else
    .move_in_parts = NAME(move_in_parts),
    .move_both = NAME(move_both),
    .run_rounds = NAME(run_rounds),
    .evaluate = NAME(evaluate),
    .invert = NAME(invert),
    .correct = NAME(correct),
    .linearise = NAME(linearise),
#endif
};
