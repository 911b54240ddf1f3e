/* choose.c - selects the functions of curves that are compiled for the instruction set of a system's tapes.
 * curve_workspace.c calls it when an integrator is made; action.c and curve.c call it in steps. */
#include "generating/curve_stepper.h"

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
