/* choose.c - selects the functions of curves that are compiled for the instruction set of a system's tapes. It also
 * selects the fast-path step of a method (curve_step.h), which makes a whole step in the common case. curve_stepper.c
 * calls it when an integrator is made; action.c and curve.c call it in steps. */
#include "generating/curve_stepper.h"
#include "method/method.h"

static const tvi_curve_isa_functions *const functions_of_isa[JET_ISA_COUNT] = {
    [jet_isa_base] = &tvi_curve_isa_functions_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = &tvi_curve_isa_functions_avx2,
    [jet_isa_avx512] = &tvi_curve_isa_functions_avx512,
#endif
};

const tvi_curve_isa_functions *tvi_choose_curve_isa_functions(const jet_tape *tape)
{
    return functions_of_isa[tape->sweeps->isa];
}

bool tvi_has_fast_path_step(const tvi_system *system, const tvi_options *options)
{
    const tvi_action action = tvi_create_unallocated_action(system, options);
    return tvi_find_method(options)->curve.correct_ends_by_generating_function ==
               tvi_solve_end_corrections_by_mean_q_jacobian &&
           options->passes != TVI_PREDICT_ONLY && seeds_need_no_second_derivatives(&action) &&
           2 * system->n <= LINEAR_OWN_MAX_ROWS && tvi_curve_choose_jacobian_method(system) == TVI_JACOBIAN_MATRICES;
}

tvi_fast_path_step_fn *tvi_choose_fast_path_step(const tvi_corrected_curve *corrected, const tvi_options *options)
{
    if (!tvi_has_fast_path_step(corrected->system, options)) return NULL;
    const tvi_curve_isa_functions *functions = tvi_choose_curve_isa_functions(corrected->system->field_series);
    return functions->fast_path_step;
}
