/* sweep.c - Computes the values, series, tangents and adjoints of a tape as an interpreter. Each of these sweeps goes
 * through the runs of equal operations once, and calls the rule of each run's operation (rule.h). The file is compiled
 * once for each instruction set. */
#include "sums.h"

#define RULE(op, name) [op] = &JET_RULE_OF(name),
const jet_rule *const jet_rules[OP_COUNT] = {JET_RULE_LIST(RULE)};

static double *locate_numbers_of_slot(double *block, int slot, int lanes)
{
    return block + (size_t)slot * (size_t)lanes;
}

JET_INLINE bool sweep_values_inlined(const jet_tape *tape, double *block, int lanes)
{
    bool inside = true;
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++) {
        if (jet_is_sum_of_products(run->op)) jet_compute_product_values(tape, run, block, lanes);
        else if (run->op == OP_LINEAR) jet_compute_linear_values(tape, run, block, lanes);
        else
            inside &= jet_rules[run->op]->compute_values(
                run->exponent, run->operation_count * lanes, locate_numbers_of_slot(block, run->a, lanes),
                locate_numbers_of_slot(block, run->b, lanes), locate_numbers_of_slot(block, run->z, lanes));
    }
    return inside;
}

/* Computes the values. The usual numbers of lanes, 1 and 8, are constants for the compiler. */
static bool sweep_values(const jet_tape *tape, double *block, int lanes)
{
    return lanes == 1   ? sweep_values_inlined(tape, block, 1)
           : lanes == 8 ? sweep_values_inlined(tape, block, 8)
                        : sweep_values_inlined(tape, block, lanes);
}

JET_INLINE bool sweep_series_inlined(const jet_tape *tape, double *block, int order, int lanes)
{
    if (order == 0) return sweep_values(tape, block, lanes);
    const size_t stride = (size_t)tape->slot_count;
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++) {
        if (jet_is_sum_of_products(run->op)) jet_compute_product_series_order(tape, run, block, order, lanes);
        else if (run->op == OP_LINEAR)
            jet_compute_linear_part(tape, run, block + (size_t)order * stride * (size_t)lanes, lanes);
        else jet_rules[run->op]->compute_series_order(run, block, order, stride, lanes);
    }
    return true;
}

static bool sweep_series(const jet_tape *tape, double *block, int order, int lanes)
{
    return lanes == 1 ? sweep_series_inlined(tape, block, order, 1) : sweep_series_inlined(tape, block, order, lanes);
}

static void sweep_tangents(const jet_tape *tape, const double *block, double *tangent_block, int order,
                           int direction_count)
{
    const size_t stride = (size_t)tape->slot_count;
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++) {
        if (jet_is_sum_of_products(run->op))
            jet_compute_product_tangents(tape, run, block, tangent_block, order, 1, direction_count);
        else if (run->op == OP_LINEAR)
            jet_compute_linear_part(tape, run, tangent_block + (size_t)order * stride * (size_t)direction_count,
                                    direction_count);
        else jet_rules[run->op]->compute_tangents(run, block, tangent_block, order, stride, direction_count);
    }
}

static void sweep_one_tangent_per_lane(const jet_tape *tape, const double *block, double *tangent_block, int order,
                                       int lanes)
{
    const size_t stride = (size_t)tape->slot_count * (size_t)lanes;
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++) {
        if (jet_is_sum_of_products(run->op))
            jet_compute_product_tangents(tape, run, block, tangent_block, order, lanes, lanes);
        else if (run->op == OP_LINEAR)
            jet_compute_linear_part(tape, run, tangent_block + (size_t)order * stride, lanes);
        else {
            const jet_run_of_operations all = jet_flatten_run_lanes(run, lanes);
            jet_rules[run->op]->compute_tangents(&all, block, tangent_block, order, stride, 1);
        }
    }
}

static void sweep_adjoints(const jet_tape *tape, const double *block, double *adjoint_block, int order, int top_order)
{
    const size_t stride = (size_t)tape->slot_count;
    for (const jet_run_of_operations *run = tape->runs + tape->run_count; run-- > tape->runs;) {
        if (jet_is_sum_of_products(run->op))
            jet_add_product_adjoints(tape, run, block, adjoint_block, order, top_order);
        else if (run->op == OP_LINEAR) jet_add_linear_adjoints(tape, run, adjoint_block + (size_t)order * stride);
        else jet_rules[run->op]->add_adjoints(run, block, adjoint_block, order, top_order, stride);
    }
}

/* The build says which set it is, and gives all names of other sets than the base its suffix (isa.c). */
#ifndef JET_ISA
#define JET_ISA jet_isa_base
#endif
const jet_sweeps jet_interpreter = {.isa = JET_ISA,
                                    .values = sweep_values,
                                    .series = sweep_series,
                                    .tangents = sweep_tangents,
                                    .one_tangent_per_lane = sweep_one_tangent_per_lane,
                                    .adjoints = sweep_adjoints};
