/* step_size.c - estimates the usable step of a curve, and rescales the curve to it: calls the functions of step_size.h,
 * or those of the system's generated code if it has them. curve_stepper.c calls it for steps of adapted size. */
#include "generating/step_size.h"
#include "generating/curve_stepper.h"

static bool has_generated_functions(const tvi_curve *curve)
{
    return curve->generated_code && curve->generated_code->usable_step;
}

double tvi_curve_estimate_usable_step(const tvi_curve *curve, double log_tolerance)
{
    return has_generated_functions(curve) ? curve->generated_code->usable_step(curve, log_tolerance)
                                          : curve_estimate_usable_step(curve, log_tolerance);
}

void tvi_curve_rescale_and_sum(tvi_curve *curve, double factor, double dq[], double du[])
{
    if (has_generated_functions(curve)) curve->generated_code->rescale_and_sum(curve, factor, dq, du);
    else tvi_choose_curve_variant(curve->system->field_series)->rescale_and_sum(curve, factor, dq, du);
}

double tvi_curve_bound_energy_change(const tvi_curve *curve)
{
    return has_generated_functions(curve) ? curve->generated_code->energy_change_bound(curve)
                                          : curve_bound_energy_change(curve);
}
