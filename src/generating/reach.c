/* reach.c - calls the functions of reach.h, or those of the curve's generated code if it has them. */
#include "generating/reach.h"
#include "generating/curve.h"
#include "generating/seeds.h"

static tvi_end_at_fn *const end_at_of[JET_ISA_COUNT] = {
    [jet_isa_base] = tvi_end_at_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = tvi_end_at_avx2,
    [jet_isa_avx512] = tvi_end_at_avx512,
#endif
};

static bool has_code(const tvi_curve *curve) { return curve->code && curve->code->reach; }

double tvi_curve_reach(const tvi_curve *curve, double log_tolerance)
{
    return has_code(curve) ? curve->code->reach(curve, log_tolerance) : curve_reach(curve, log_tolerance);
}

void tvi_curve_end_at(tvi_curve *curve, double factor, double q[], double u[])
{
    if (has_code(curve)) curve->code->end_at(curve, factor, q, u);
    else end_at_of[curve->system->field_series->sweeps->isa](curve, factor, q, u);
}

double tvi_curve_change(const tvi_curve *curve)
{
    return has_code(curve) ? curve->code->change(curve) : curve_change(curve);
}
