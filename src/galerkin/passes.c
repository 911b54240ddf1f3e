/* passes.c - see passes.h. */
#include "galerkin/passes.h"
#include "method/asked.h"

#include <float.h>
#include <math.h>

/* Sizes are squares, summed over all unknowns and lanes, relative to the sizes of the unknowns; here of one of them.
 * What a step leaves out has the same sign in the next one, where roundoff changes its sign: it stays below the
 * roundoff of N steps if it is that of one step / sqrt(N), with 2^-80 for more than 10^9 of them. A Newton method,
 * whose passes cost more, does so for 2^16 times fewer. Passes of a small step soon do no more than roundoff, which
 * does not show how far they contract: then they do as those of an earlier step did. In the equations of a Hamiltonian
 * the passes of Q may contract as little as those of P contract much, in turns. */
#define SQUARE(x) ((x) * (x))
#define RULE(GOAL)                                                                                                     \
    .most = 100, .goal = SQUARE(GOAL), .noise = SQUARE(32 * DBL_EPSILON), .contraction = SQUARE(0.5),                  \
    .stuck = TVI_PASSES_ALL, .turns = 2
const tvi_passes_rule tvi_galerkin_fixed_point = {RULE(0x1p-80)};
const tvi_passes_rule tvi_galerkin_quasi_newton = {RULE(0x1p-72)};
const tvi_passes_rule tvi_galerkin_newton = {RULE(0x1p-72), .is_quadratic = true};

tvi_passes_rule tvi_galerkin_rule(const tvi_passes_rule *of_one, int numbers, const tvi_options *o)
{
    tvi_passes_rule rule = *of_one;
    rule.goal *= numbers;
    rule.noise *= numbers;
    return tvi_passes_rule_asked(&rule, o, SQUARE(o->tolerance));
}

tvi_status tvi_galerkin_iterate(galerkin_field *field, galerkin_probe *probe, const tvi_passes_rule *rule,
                                const tvi_origin *origin, galerkin_pace *pace, tvi_stats *stats)
{
    tvi_passes passes;
    bool is_stuck = false;
    int count = 0;
    double moved;
    tvi_passes_begin(&passes, pace->slowest);
    while (++count <= rule->most) {
        const bool suspects =
            is_stuck && passes.roundoff == 0 && count < rule->most && tvi_galerkin_is_near(field, origin);
        count += suspects;
        const tvi_status status = suspects ? tvi_galerkin_measure(field, probe, &moved, &passes.roundoff, stats)
                                           : tvi_galerkin_pass(field, &moved, stats);
        if (status != TVI_OK) return status;
        const tvi_passes_verdict verdict = tvi_passes_judge(&passes, rule, moved);
        is_stuck |= verdict == TVI_PASSES_STUCK;
        if (count == 1) pace->first = moved;
        if (verdict == TVI_PASSES_MAY_END) {
            stats->residual = sqrt(moved);
            pace->slowest = passes.slowest;
            return TVI_OK;
        }
    }
    return TVI_ENOCONV;
}
