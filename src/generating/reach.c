/* reach.c - calls the functions of reach.h, or those of the curve's generated code if it has them. */
#include "generating/taylor_loops.h"
#include "generating/reach.h"
#include "generating/curve.h"
#include "generating/seeds.h"

static bool has_code(const tvi_curve *curve) { return curve->code && curve->code->reach; }

double tvi_curve_reach(const tvi_curve *curve, double log_tolerance)
{
    return has_code(curve) ? curve->code->reach(curve, log_tolerance) : curve_reach(curve, log_tolerance);
}

void tvi_curve_end_at(tvi_curve *curve, double factor, double q[], double u[])
{
    if (has_code(curve)) curve->code->end_at(curve, factor, q, u);
    else curve_end_at(curve, factor, q, u);
}

double tvi_curve_change(const tvi_curve *curve)
{
    return has_code(curve) ? curve->code->change(curve) : curve_change(curve);
}
