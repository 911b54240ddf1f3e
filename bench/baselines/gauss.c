/* gauss.c - Runs Gauss collocation of orders 4 to 16, the limit of the Galerkin variational integrators (docs/method.md
 * section 4), solved by fixed point to roundoff from the extrapolated accelerations of the step before. */
#include "forces.h"
#include "gauss_tableau.h"
#include "state.h"

enum { MOST_PASSES = 100 };
static const double ROUNDOFF = 1e-13; /* relative: below it, a pass that no longer converges ends the iteration */

#define LANES 4
#include "gauss_lanes.h"
#undef LANES
#define LANES 8
#include "gauss_lanes.h"
#undef LANES

typedef tvi_status gauss_fn(const baseline_task *task, double q[], double p[], baseline_counts *counts);

/* One function for each force and number of nodes, so that both are known to the compiler. */
#define GAUSS(name, n, s, lanes)                                                                                       \
    static tvi_status name##_gauss_##s(const baseline_task *task, double q[], double p[], baseline_counts *counts)     \
    {                                                                                                                  \
        return gauss_##lanes(n, s, name##_##lanes, task, q, p, counts);                                                \
    }
#define ALL_GAUSS(name, n)                                                                                             \
    GAUSS(name, n, 2, 4)                                                                                               \
    GAUSS(name, n, 3, 4)                                                                                               \
    GAUSS(name, n, 4, 4)                                                                                               \
    GAUSS(name, n, 5, 8)                                                                                               \
    GAUSS(name, n, 6, 8)                                                                                               \
    GAUSS(name, n, 7, 8)                                                                                               \
    GAUSS(name, n, 8, 8)
FORCES_BY_HAND(ALL_GAUSS)

#define ROW(name, n)                                                                                                   \
    {NULL,           NULL,           name##_gauss_2, name##_gauss_3, name##_gauss_4,                                   \
     name##_gauss_5, name##_gauss_6, name##_gauss_7, name##_gauss_8},
static gauss_fn *const functions[FORCES][GAUSS_STAGES_MAX + 1] = {FORCES_BY_HAND(ROW)};

static tvi_status run(const baseline *self, const baseline_task *task, double q[], double p[], baseline_counts *counts)
{
    *counts = (baseline_counts){0};
    return functions[force_of(task->scene)][self->order / 2](task, q, p, counts);
}

#define BASELINE(order_)                                                                                               \
    {                                                                                                                  \
        .name = "gauss", .order = order_, .symplectic = true, .run = run                                               \
    }
const baseline baselines_gauss[] = {BASELINE(4),  BASELINE(6),  BASELINE(8),  BASELINE(10),
                                    BASELINE(12), BASELINE(14), BASELINE(16), {.name = NULL}};
