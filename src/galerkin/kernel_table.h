/* kernel_table.h - Defines the table of the kernels that kernel.h has just defined. loops.c includes it. */
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
    .move_with_changes = NAME(move_with_changes),
    .run_inner_iterations = NAME(run_inner_iterations),
    .evaluate = NAME(evaluate),
    .invert = NAME(invert),
    .correct = NAME(correct),
    .linearise = NAME(linearise),
#endif
};
