/* kernel_table.h - Defines the table of the kernels that kernel.h has just defined. loops.c includes it. */
static const galerkin_kernels NAME(kernels) = {
    .set_constant_drift_values = NAME(set_constant_drift_values),
    .set_linear_drift_values = NAME(set_linear_drift_values),
    .predict = NAME(predict),
    .set_sizes = NAME(set_sizes),
    .move = NAME(move),
    .sum_impulses = NAME(sum_impulses),
    .compute_drifting_increments = NAME(compute_drifting_increments),
    .compute_increments = NAME(compute_increments),
    .compute_tail = NAME(compute_tail),
    .move_in_parts = NAME(move_in_parts),
    .move_with_changes = NAME(move_with_changes),
    .run_inner_iterations = NAME(run_inner_iterations),
    .evaluate = NAME(evaluate),
    .invert = NAME(invert),
    .correct_velocities = NAME(correct_velocities),
    .linearise = NAME(linearise),
};
