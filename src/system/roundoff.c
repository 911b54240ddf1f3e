/* roundoff.c - how well the values of a field are known. */
#include "system/roundoff.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { LEAST_SAMPLES = 4 }; /* of signs: in one alone the parts of a sum may cancel */

static int outputs_of(const tvi_system *system) { return system->form == TVI_SEPARABLE ? system->n : 2 * system->n; }

void tvi_roundoff_take(tvi_roundoff *roundoff, tvi_arena *arena, const tvi_system *system, int lanes)
{
    const size_t outputs = (size_t)outputs_of(system), width = (size_t)lanes;
    roundoff->change = tvi_arena_doubles(arena, outputs);
    roundoff->inputs = tvi_arena_doubles(arena, (size_t)system->inputs * width);
    roundoff->outputs = tvi_arena_doubles(arena, outputs * width);
}

double tvi_roundoff_sign(tvi_roundoff *roundoff, double size)
{
    roundoff->random = roundoff->random * 1664525u + 1013904223u;
    return roundoff->random >> 31 ? -size : size;
}

/* One sample: the block is run at inputs that have moved, and again where they were. */
static void sample(tvi_roundoff *roundoff, const tvi_system *system, const jet_tape *tape, double *x, int lanes)
{
    const size_t width = (size_t)lanes, row = width * sizeof *x;
    for (size_t i = 0; i < (size_t)system->inputs * width; i++) x[i] += tvi_roundoff_sign(roundoff, DBL_EPSILON * x[i]);
    const bool inside = jet_sweep_values(tape, x, lanes);
    for (int i = 0; i < outputs_of(system); i++)
        memcpy(roundoff->outputs + (size_t)i * width, x + (size_t)tape->output[i] * width, row);
    memcpy(x, roundoff->inputs, (size_t)system->inputs * row);
    if (!jet_sweep_values(tape, x, lanes) || !inside) return;
    for (int i = 0; i < outputs_of(system); i++)
        for (size_t lane = 0; lane < width; lane++)
            roundoff->change[i] = fmax(roundoff->change[i], fabs(roundoff->outputs[(size_t)i * width + lane] -
                                                                 x[(size_t)tape->output[i] * width + lane]));
}

int tvi_roundoff_of_field(tvi_roundoff *roundoff, const tvi_system *system, const jet_tape *tape, double *x, int lanes)
{
    const int samples = (LEAST_SAMPLES + lanes - 1) / lanes;
    roundoff->random = 1;
    memcpy(roundoff->inputs, x, (size_t)system->inputs * (size_t)lanes * sizeof *x);
    memset(roundoff->change, 0, (size_t)outputs_of(system) * sizeof *roundoff->change);
    for (int i = 0; i < samples; i++) sample(roundoff, system, tape, x, lanes);
    return 2 * samples;
}
