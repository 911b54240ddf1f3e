/* reach.c - estimates the usable step of a curve and rescales the curve: it calls the functions of reach.h, or those
 * of the system's generated code if it has them. curve_stepper.c calls it for steps of adapted size. */
#include "generating/reach.h"
#include "generating/curve.h"
#include "generating/seeds.h"

static bool has_generated_functions(const tvi_curve *curve)
{
    return curve->generated_code && curve->generated_code->reach;
}

double tvi_curve_estimate_usable_step(const tvi_curve *curve, double log_tolerance)
{
    return has_generated_functions(curve) ? curve->generated_code->reach(curve, log_tolerance)
                                          : curve_estimate_usable_step(curve, log_tolerance);
}

void tvi_curve_rescale_and_sum(tvi_curve *curve, double factor, double q[], double u[])
{
    if (has_generated_functions(curve)) curve->generated_code->end_at(curve, factor, q, u);
    else tvi_choose_rescale_and_sum(curve->system)(curve, factor, q, u);
}

double tvi_curve_bound_energy_change(const tvi_curve *curve)
{
    return has_generated_functions(curve) ? curve->generated_code->change(curve) : curve_bound_energy_change(curve);
}
