/* sooner.c - see sooner.h: the library's steps with another rule, which take the place of its own in the program. */
#include "sooner.h"
#include "algebra/passes.h"

_Thread_local bool passes_end_sooner;

/* The square of how many times the rule's roundoff: first passes may grow. */
#define SMALL 1024

static inline tvi_passes_verdict judge(tvi_passes *passes, const tvi_passes_rule *rule, double size)
{
    const double before = passes->size;
    const tvi_passes_verdict verdict = tvi_passes_judge(passes, rule, size);
    if (!passes_end_sooner) return verdict;
    return size == 0 || (size >= before && size <= SMALL * rule->noise) ? TVI_PASSES_MAY_END : TVI_PASSES_GO_ON;
}

#define tvi_passes_judge judge
#include "galerkin/galerkin.c"
