/* sooner.c - see sooner.h. */
#include "sooner.h"
#include "galerkin/passes.h"

#include <math.h>

_Thread_local bool passes_end_sooner;

/* The square of how many times the rule's roundoff: first passes may grow. */
#define SMALL 1024

/* Names that the linker gives. */
#define REAL __real_tvi_galerkin_iterate
#define WRAP __wrap_tvi_galerkin_iterate
tvi_status REAL(galerkin_field *field, galerkin_probe *probe, const tvi_passes_rule *rule, const tvi_origin *origin,
                galerkin_pace *pace, tvi_stats *stats);
tvi_status WRAP(galerkin_field *field, galerkin_probe *probe, const tvi_passes_rule *rule, const tvi_origin *origin,
                galerkin_pace *pace, tvi_stats *stats);

tvi_status WRAP(galerkin_field *field, galerkin_probe *probe, const tvi_passes_rule *rule, const tvi_origin *origin,
                galerkin_pace *pace, tvi_stats *stats)
{
    double before = INFINITY, moved;
    if (!passes_end_sooner) return REAL(field, probe, rule, origin, pace, stats);
    for (int count = 1; count <= rule->most; count++, before = moved) {
        const tvi_status status = tvi_galerkin_pass(field, &moved, stats);
        if (status != TVI_OK) return status;
        if (count == 1) pace->first = moved;
        stats->residual = sqrt(moved);
        if (moved == 0 || (moved >= before && moved <= SMALL * rule->noise)) return TVI_OK;
    }
    return TVI_ENOCONV;
}
