/* curve_isa.c - compiles the seeds of the action and the rescaling of a curve for one instruction set, and lists all
 * functions compiled for it. The build compiles this file once for each instruction set; choose.c selects among the
 * results. */
#define CURVE_ONE_SET
#include "sums.h"

#include "generating/curve_stepper.h"
#include "generating/step_size.h"

extern const tvi_end_correction_solver JET_FOR_ISA(tvi_solver_by_products);

const tvi_curve_isa_functions JET_FOR_ISA(tvi_curve_isa_functions) = {
    .rescale_and_sum = curve_rescale_and_sum,
    .compute_seeds = seeds_compute_adjoint_seeds_from_field_only,
    .matrix_free_solver = &JET_FOR_ISA(tvi_solver_by_products)};
