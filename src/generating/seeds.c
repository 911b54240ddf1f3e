/* seeds.c - computes the seeds of a field at nodes on the curve (seeds.h), compiled once for each instruction set. */
#define CURVE_ONE_SET
#include "sums.h"

#include "generating/action.h"

tvi_status JET_FOR_ISA(tvi_seeds_plainly)(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[])
{
    return seeds_plainly(action, curve, seed_Q, seed_U);
}
