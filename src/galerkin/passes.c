/* passes.c - see passes.h. */
#include "galerkin/passes.h"
#include "algebra/passes.h"

#include <float.h>
#include <math.h>

enum { MAX_PASSES = 100 };

/* The passes of a step. All sizes are squares, summed over all unknowns and lanes, relative to the sizes of the
 * unknowns. */
typedef struct {
    tvi_passes passes;  /* how far they moved */
    double contraction; /* of the last pass that was above roundoff */
    double slowest;     /* contraction of the last two such passes; of a Newton method, of the last */
    double expected;    /* movement of the last pass, without its roundoff */
    double roundoff;    /* what may be roundoff, as measured; 0: not yet */
    bool is_stuck;      /* the passes shrink no more, though they move by more than roundoff usually is */
} galerkin_progress;

/* Squares of relative movements: one after which there must be another pass, one that may be roundoff, one that is
 * none, and one that no sum of many steps shows. What a step leaves out has the same sign in the next one, where
 * roundoff changes its sign: it stays below the roundoff of N steps if it is that of one step / sqrt(N), here for more
 * than 10^9 of them. A Newton method, whose passes cost more, does so for 2^16 times fewer. */
static double square(double x) { return x * x; }
#define FAR            square(1e-9)
#define MAYBE_ROUNDOFF square(1e-12)
#define ROUNDOFF       square(32 * DBL_EPSILON)
#define NOTHING        square(0x1p-80)
#define NEWTON_NOTHING square(0x1p-72)

static double larger(double a, double b) { return a > b ? a : b; }
static double smaller(double a, double b) { return a < b ? a : b; }

static bool contracts(const galerkin_progress *at) { return at->slowest > 0 && at->slowest < 0.25; }

/* Whether what the next pass would move is nothing. Passes of a small step soon do no more than roundoff, which does
 * not show how far they contract: then they do as those of an earlier step did. */
static bool is_converged(galerkin_progress *at, double count, bool is_newton)
{
    const double moved = at->passes.size;
    if (moved > ROUNDOFF * count || (is_newton && at->slowest == 0)) {
        const double contraction = tvi_passes_contraction(&at->passes);
        at->slowest = is_newton ? contraction : larger(contraction, at->contraction);
        at->contraction = contraction;
        at->expected = moved;
    } else {
        at->expected = at->slowest > 0 ? smaller(moved, at->slowest * at->expected) : moved;
    }
    return contracts(at) && at->slowest * at->expected <= (is_newton ? NEWTON_NOTHING : NOTHING) * count;
}

/* Two passes, since in the equations of a Hamiltonian those of Q may contract as little as those of P contract much, in
 * turns. */
static bool shrinks_no_more(const tvi_passes *passes)
{
    return passes->size >= passes->before && passes->size >= passes->earlier;
}

/* The last bits go to and fro, and nothing else moves. */
static bool is_cycle(const tvi_passes *passes)
{
    return passes->size == passes->before && passes->size == passes->earlier;
}

/* Whether the passes may end here, or do no more than roundoff. */
static bool is_enough(const galerkin_field *field, const tvi_options *o, galerkin_progress *at)
{
    const double count = field->nodes.unknowns * field->nodes.lanes, moved = at->passes.size;
    bool is_last = moved == 0 || moved <= at->roundoff;
    if (o->tolerance > 0) is_last |= moved <= square(o->tolerance);
    else if (isinf(at->passes.before)) at->expected = moved;
    else if (moved <= FAR * count) is_last |= is_converged(at, count, field->form->is_newton);
    if (shrinks_no_more(&at->passes)) {
        if (moved > MAYBE_ROUNDOFF * count) at->is_stuck = true;
        else is_last |= !contracts(at) || is_cycle(&at->passes);
    }
    return is_last;
}

tvi_status tvi_galerkin_iterate(galerkin_field *field, galerkin_probe *probe, const tvi_options *o,
                                const tvi_origin *origin, double *slowest, tvi_stats *stats)
{
    const int most = o->passes > 0 ? o->passes : o->max_passes > 0 ? o->max_passes : MAX_PASSES;
    galerkin_progress at = {.passes = TVI_NO_PASSES, .slowest = *slowest};
    for (int count = 1; count <= most; count++) {
        double moved;
        const bool suspects = at.is_stuck && at.roundoff == 0 && count < most && tvi_galerkin_is_near(field, origin);
        count += suspects;
        const tvi_status status = suspects ? tvi_galerkin_measure(field, probe, &moved, &at.roundoff, stats)
                                           : tvi_galerkin_pass(field, &moved, stats);
        if (status != TVI_OK) return status;
        tvi_passes_add(&at.passes, moved);
        if (o->passes > 0 ? count == o->passes : is_enough(field, o, &at)) {
            stats->residual = sqrt(moved);
            *slowest = at.slowest;
            return TVI_OK;
        }
    }
    return TVI_ENOCONV;
}
