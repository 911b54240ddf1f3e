/* baseline.c - Lists the integrators that the library is measured against, and checks which scenes they serve
 * (baseline.h). */
#include "forces.h"

#include <string.h>

#ifndef BASELINE_FLAGS
#define BASELINE_FLAGS "unknown"
#endif
const char *const baseline_flags = BASELINE_FLAGS;

static const baseline *const lists[] = {
    baselines_composition, baselines_shooting, baselines_gauss, baselines_taylor,
#ifdef BASELINES_GSL
    baselines_gsl,
#endif
#ifdef BASELINES_SUNDIALS
    baselines_sundials,
#endif
};

const baseline *baseline_at(int index)
{
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        for (const baseline *b = lists[i]; b->name; b++)
            if (index-- == 0) return b;
    return NULL;
}

const baseline *baseline_find(const char *name, int order)
{
    const baseline *b;
    for (int i = 0; (b = baseline_at(i)); i++)
        if (strcmp(b->name, name) == 0 && b->order == order) return b;
    return NULL;
}

bool baseline_serves(const baseline *b, const scene *s)
{
    return b->serves ? b->serves(b, s) : force_of(s) != FORCE_NONE;
}
