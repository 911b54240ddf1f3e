/* gauss_recorded.c - Runs Gauss collocation on a recorded force (gauss_recorded.h). */
#include "gauss_recorded.h"
#include "baselines/forces.h"
#include "baselines/gauss_tableau.h"
#include "baselines/state.h"
#include "system/system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PASSES = 100 };
static const double ROUNDOFF = 1e-13; /* as in gauss.c */

#define LANES 8
#include "baselines/gauss_lanes.h"

/* The current force of gauss_lanes.h, which has no context. */
static const tvi_system *recorded;
static double *block; /* of its tape */

/* a = M^-1 F(q) at LANES points, NaN outside of the domain. */
static void acceleration(const double *restrict q, double *restrict a)
{
    const jet_tape *tape = recorded->field_values;
    const int n = recorded->n;
    memcpy(block, q, (size_t)(n * LANES) * sizeof *q);
    const bool inside = jet_sweep_values(tape, block, LANES);
    for (int k = 0; k < n; k++)
        for (int l = 0; l < LANES; l++)
            a[k * LANES + l] = inside ? block[tape->output_slot[k] * LANES + l] / recorded->mass[k] : NAN;
}

tvi_status gauss_recorded(const tvi_system *system, int order, const baseline_task *task, double q[], double p[],
                          baseline_counts *counts)
{
    *counts = (baseline_counts){0};
    block = malloc((size_t)(system->field_values->slot_count * LANES) * sizeof *block);
    if (!block) return TVI_ENOMEM;
    recorded = system;
    jet_tape_write_constants(system->field_values, block, 1, LANES);
    const tvi_status status = gauss_8(system->n, order / 2, acceleration, task, q, p, counts);
    free(block);
    return status;
}
