/* stiffness.c - see stiffness.h. */
#include "system/stiffness.h"
#include "algebra/sizes.h"

#include <math.h>
#include <string.h>

enum { DIRECTIONS = 8 }; /* at a time */

void tvi_stiffness_take(tvi_stiffness *stiffness, tvi_arena *arena, const tvi_system *system)
{
    stiffness->system = system;
    stiffness->x = tvi_arena_block(arena, system->field_series, 1, 1, 0);
    stiffness->dx = tvi_arena_doubles(arena, (size_t)system->field_series->slots * DIRECTIONS);
}

/* Of so many directions at once. */
static void multiply(const tvi_stiffness *stiffness, const jet_tape *tape, int count, const double along[],
                     double product[])
{
    const tvi_system *system = stiffness->system;
    double *dx = stiffness->dx;
    memset(dx, 0, (size_t)(tape->slots * count) * sizeof *dx);
    for (int i = 0; i < system->n; i++)
        for (int k = 0; k < count; k++) dx[i * count + k] = along[k * system->n + i] / sqrt(system->mass[i]);
    jet_sweep_tangents(tape, stiffness->x, dx, 0, count);
    for (int i = 0; i < system->n; i++)
        for (int k = 0; k < count; k++)
            product[k * system->n + i] = dx[tape->output[i] * count + k] / sqrt(system->mass[i]);
}

int tvi_stiffness_times(const tvi_stiffness *stiffness, double t, const double q[], int count, const double along[],
                        double product[])
{
    const tvi_system *system = stiffness->system;
    const int n = system->n;
    jet_tape tape = *system->field_series;
    tape.sweeps = tape.interpreted; /* generated code has other numbers of directions */
    memcpy(stiffness->x, q, (size_t)n * sizeof *q);
    tvi_system_set_time(system, stiffness->x, 1, &t);
    if (!jet_sweep_values(&tape, stiffness->x, 1)) return 0;
    for (int k = 0; k < count; k += DIRECTIONS)
        multiply(stiffness, &tape, count - k < DIRECTIONS ? count - k : DIRECTIONS, along + k * n, product + k * n);
    return tvi_all_finite(count * n, product) ? 1 + count : 0;
}
